#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apriltrack/base/log.h"
#include "apriltrack/camera/camera.h"

namespace apriltrack {

/// Cameras of which some have `response: auto` in their file: to be estimated from images of tags.
struct UnestimatedRig {
  CameraRig rig;                         ///< Those have sRGB, assumed.
  std::vector<std::string> to_estimate;  ///< Their names.
};

/// As read_cameras(), which refuses `response: auto`.
UnestimatedRig read_cameras_to_estimate(const std::filesystem::path& path, const LogSink& log = silent_log());

}  // namespace apriltrack
