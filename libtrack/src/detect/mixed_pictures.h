#pragma once

#include <optional>
#include <span>
#include <string>

#include "apriltrack/camera/camera.h"
#include "apriltrack/detect/detection.h"

namespace apriltrack {

struct PictureSizeChange {
  const FrameDetections* first_after = nullptr;
  std::string words;  ///< With both times.
};

/// Where the camera's pictures change to another size: from one frame to the next all corners go to the same
/// share of where they were, and tags to that share of their size, by a scale by which pictures of one sensor
/// differ. No movement of the camera does that about the upper left corner. nullopt where nothing looks
/// so. frames: of any cameras, in the order of time.
std::optional<PictureSizeChange> change_of_picture_size(std::span<const FrameDetections> frames,
                                                        const Camera& camera);

}  // namespace apriltrack
