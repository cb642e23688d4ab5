#pragma once

#include <optional>

#include "apriltrack/camera/camera.h"
#include "apriltrack/image/frame.h"
#include "apriltrack/tracker/track_result.h"

namespace apriltrack {

/// Lost, with the reason, where the frame is none of this camera's: its image is empty, or not of the
/// camera's resolution. nullopt where it may be: a camera without a resolution (width or height 0) takes any.
std::optional<TrackResult> lost_to_another_camera(const Frame& frame, const Camera& camera);

}  // namespace apriltrack
