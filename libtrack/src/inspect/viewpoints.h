#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "apriltrack/detect/detection.h"
#include "apriltrack/tags/tag_key.h"

namespace apriltrack {

/// A tag in one camera's frame; corners as of Detection.
struct ViewedTag {
  std::string camera;
  TagKey tag;
  std::array<Eigen::Vector2d, kNumCorners> corners_px;
};

/// What all cameras of a rig show at one time.
using RigView = std::vector<ViewedTag>;

/// Of each viewpoint that `views` were taken from, the tags that it ever showed, each once; viewpoints in the
/// order of their first view. A camera that stands still has one viewpoint, as for a calibration
/// (find_camera_places() by CalibrationOptions::same_place_px).
std::vector<std::vector<TagKey>> tags_by_viewpoint(std::span<const RigView> views);

}  // namespace apriltrack
