#pragma once

#include <optional>

#include "apriltrack/motion/motion_state.h"

namespace apriltrack {

/// Between frames, where nothing tells it.
inline constexpr double kUsualInterval_s = 1.0 / 30.0;

/// How the velocity changes while the shutter is open, as the motion since the frame before lets expect: the
/// picture itself hardly tells.
struct PathBend {
  Vector6d acceleration = Vector6d::Zero();
  Vector6d sigma = Vector6d::Zero();  ///< Of each number of `acceleration`.
};

/// Of the velocity since the frame before, interval_s ago: what of its change is an acceleration that goes on
/// through the exposure, 1/s. Of a change over longer, less: what hands do in a tenth of a second is over
/// then.
double acceleration_per_change(double interval_s);

/// velocity: found in this frame. expected: the one before would have led here with, unchanged; interval_s:
/// since then, > 0. Both nullopt where nothing was known before.
PathBend expected_bend(const Vector6d& velocity, const std::optional<Vector6d>& expected,
                       const std::optional<double>& interval_s, const MotionNoise& noise);

/// Of the pose in the middle of an exposure, what accelerations that are off by sigma make of it: the fit
/// lays a path without them through the mean of the places passed (docs/algorithms/blur_tracker.md, equation
/// 12).
Matrix6d bend_covariance(const Vector6d& sigma, double exposure_s);

}  // namespace apriltrack
