#pragma once

#include <optional>
#include <vector>

#include "apriltrack/sim/scene.h"

namespace apriltrack {

/// How one tag of the map is seen in one frame.
struct TagView {
  TagKey key;
  std::array<Eigen::Vector2d, 4> corners_px;  ///< At the time stamp, raw (distorted) pixels.
  double blur_px = 0.0;  ///< Longest path of a corner during the exposure, first half plus second half.
};

/// Tags of the map that the frame shows: centre in the image, less than 80 degrees from facing the camera,
/// all corners in front. Occlusion is not regarded.
std::vector<TagView> tag_views(const Scene& scene, Timestamp middle);

/// The longest blur of the tags seen; nullopt when the frame shows none.
std::optional<double> frame_blur_px(const Scene& scene, Timestamp middle);

}  // namespace apriltrack
