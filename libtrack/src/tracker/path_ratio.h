#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "apriltrack/base/timestamp.h"
#include "apriltrack/motion/motion_state.h"
#include "exposure_estimate.h"

namespace apriltrack {

/// One frame of a motion, as its blur shows it.
struct BlurredInstant {
  Timestamp time;
  Pose pose;
  double exposure_s = 0.0;  ///< As told, or assumed: its path is `velocity` times this.
  Vector6d velocity = Vector6d::Zero();
  /// Pixels that points of the tags move, two rows a point, by the right perturbation of `pose`.
  Eigen::Matrix<double, Eigen::Dynamic, 6> pixels_by_pose;
};

/// Of three frames in a row: the velocities that the blur shows, integrated by Simpson's rule, against the
/// way from the first pose to the last. None where too little moves, or the frames lie too far apart.
std::optional<PathRatio> path_ratio(const std::array<BlurredInstant, 3>& frames, const MotionNoise& noise);

}  // namespace apriltrack
