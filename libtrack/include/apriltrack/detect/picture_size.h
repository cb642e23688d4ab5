#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "apriltrack/camera/camera.h"
#include "apriltrack/detect/detection.h"

namespace apriltrack {

/// Where a detection comes from, as messages name it: "detections.csv:17".
using DetectionPlace = std::function<std::string(const FrameDetections&, const Detection&)>;

/// Holds corners against the resolutions that the cameras are calibrated for.
///
/// A detector may put the corner of a tag that the border cuts some pixels outside (27 of 1024 in recordings
/// from elsewhere): up to 5 % of the width and height is let pass. Frames with corners beyond that are of
/// pictures of another size; so few of them that they may be misread tags are warned of. So are cameras whose
/// corners fill a picture scaled down, and no more. Cameras whose file names no resolution, or that are not
/// in `rig`, are passed over. place: names the detection in messages; by default by its time.
///
/// Throws Error(kInvalidInput) when more than 5 % of a camera's frames are so, with the first such corner,
/// the size stated and the size seen, and the intrinsics of pictures scaled so; and when they change their
/// size from one frame to the next. frames: in the order of time. Returns the warnings.
std::vector<std::string> check_picture_sizes(std::span<const FrameDetections> frames, const CameraRig& rig,
                                             const DetectionPlace& place = {});

}  // namespace apriltrack
