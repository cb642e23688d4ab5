#pragma once

#include <Eigen/Core>

#include "apriltrack/motion/motion_state.h"
#include "apriltrack/photometric/visual_gyroscope.h"

namespace apriltrack {

/// A turn of the camera, seen; what it has gone since looks like a turn, too.
struct SeenTurn {
  CameraTurn turn;
  /// Where what was seen is, about: in the camera's frame before the turn; 0.1 m off at least.
  Eigen::Vector3d scene_camera;
};

/// From one frame to the next.
struct MotionStep {
  MotionNoise noise;
  double dt_s = 0.0;
  /// Of the logarithm of what all velocities may be off by together.
  double speed_sigma = 0.0;
};

MotionBelief predicted(const MotionBelief& belief, const MotionStep& step);

/// What the motion and the turn together expect.
struct TurnedBelief {
  MotionBelief belief;
  Vector6d velocity_before;     ///< What the motion alone expects.
  double log_likelihood = 0.0;  ///< How well they agree: of the turn's density.
  bool is_believed = false;     ///< The turn is not, where they disagree by five standard deviations.
};
/// before: T_world_camera, as the frame before the turn left it.
TurnedBelief turned_by(const MotionBelief& before, const MotionStep& step, const SeenTurn& turn);

}  // namespace apriltrack
