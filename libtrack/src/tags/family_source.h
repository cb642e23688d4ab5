#pragma once

#include <span>
#include <string>
#include <string_view>

struct apriltag_family;

namespace apriltrack {

/// How one family object of the AprilTag library is made and released.
struct FamilySource {
  std::string_view name;
  apriltag_family* (*create)();
  void (*destroy)(apriltag_family*);
};

/// The one list of families; its order is that of TagFamily::names().
std::span<const FamilySource> family_sources();

/// nullptr when there is no such family.
const FamilySource* find_family_source(std::string_view name);

/// "unknown tag family 'x' (known: ...)".
std::string unknown_family_message(std::string_view name);

}  // namespace apriltrack
