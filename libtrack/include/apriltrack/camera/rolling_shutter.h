#pragma once

#include <optional>
#include <string>

#include "apriltrack/camera/camera.h"

namespace apriltrack {

/// For people: what a rolling shutter (Camera::line_delay_s) does to corners in motion, by how many pixels;
/// nullopt for a global shutter.
std::optional<std::string> rolling_shutter_warning(const Camera& camera);

}  // namespace apriltrack
