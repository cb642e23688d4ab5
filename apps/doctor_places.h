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

/// Of each moment, whether an earlier one shows the same tags, each where it does to a pixel (rms over its
/// corners, as CalibrationOptions::same_place_px): the camera stood still, or frames were copied. A stricter
/// rule than calibrate's, which takes moments for one place that share most of their tags.
std::vector<bool> are_at_rest(std::span<const Moment> moments);

}  // namespace apriltrack::app
