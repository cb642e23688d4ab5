#pragma once

#include <memory>
#include <string_view>

struct apriltag_family;

namespace apriltrack {

struct NativeFamilyDeleter {
  void operator()(apriltag_family* family) const;
};

/// A family object of the AprilTag library for the use of one LibraryDetector: its decoding tables go with
/// the first of the library's detectors that goes. Nobody else has a use for it, nor sees an AprilTag type.
using NativeFamily = std::unique_ptr<apriltag_family, NativeFamilyDeleter>;

/// Throws Error(kInvalidInput) that lists the known names.
NativeFamily make_native_family(std::string_view name);

}  // namespace apriltrack
