#pragma once

#include <memory>
#include <string_view>

struct apriltag_family;

namespace apriltrack {

struct NativeFamilyDeleter {
  void operator()(apriltag_family* family) const;
};

/// A family object of the AprilTag library for one detector's own use: they must never be shared between
/// detectors. Only the detector has a use for it; nobody else sees an AprilTag type.
using NativeFamily = std::unique_ptr<apriltag_family, NativeFamilyDeleter>;

/// Throws Error(kInvalidInput) that lists the known names.
NativeFamily make_native_family(std::string_view name);

}  // namespace apriltrack
