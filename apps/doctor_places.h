#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "apriltrack/detect/detection.h"
#include "apriltrack/tags/tag_key.h"

namespace apriltrack::app {

/// A tag in one camera's frame.
struct Sight {
  std::string camera;
  TagKey tag;
  std::array<Eigen::Vector2d, kNumCorners> corners_px;
};

/// What all cameras of a rig show at one time.
using Moment = std::vector<Sight>;

/// Of each place that moments were taken from, the tags that it ever showed, each once, in the order of the
/// places. Where the camera stood still, or frames were copied, many moments are of one place, as calibrate
/// takes them (find_camera_places() by CalibrationOptions::same_place_px).
std::vector<std::vector<TagKey>> tags_by_place(std::span<const Moment> moments);

}  // namespace apriltrack::app
