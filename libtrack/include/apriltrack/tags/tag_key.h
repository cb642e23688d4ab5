#pragma once

#include <compare>
#include <functional>
#include <string>

namespace apriltrack {

/// What identifies a tag: the same id of another family is another tag.
struct TagKey {
  std::string family = "tag36h11";
  int id = 0;

  auto operator<=>(const TagKey&) const = default;
};

/// "tag36h11/7".
std::string to_string(const TagKey& key);

}  // namespace apriltrack

template <>
struct std::hash<apriltrack::TagKey> {
  std::size_t operator()(const apriltrack::TagKey& key) const noexcept {
    return std::hash<std::string>()(key.family) * 31 + static_cast<std::size_t>(key.id);
  }
};
