#pragma once

#include "apriltrack/camera/camera.h"

namespace apriltrack {

/// What a calibration's corners err by in a bad picture, some times what they err by on average (0.2 to 0.5
/// px RMS are usual). A calibration whose optimiser was let turn the axes of a sensor, which are at a right
/// angle to 1e-5, has fitted its noise with them: the skew is of this size. A larger one is refused.
inline constexpr double kMaxSkewEffect_px = 1.0;

/// How far the skew of a camera matrix, which no model here has, moves points of the picture at most: |skew *
/// y'|, y' = (y - cy) / fy. A picture of unknown size is taken to be centred on the principal point.
double largest_skew_effect_px(double skew_px, const Camera& camera);

}  // namespace apriltrack
