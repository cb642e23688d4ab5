#pragma once

#include <Eigen/Core>

#include "apriltrack/geometry/pose.h"

namespace apriltrack {

using Vector12d = Eigen::Matrix<double, 12, 1>;
using Matrix12d = Eigen::Matrix<double, 12, 12>;

/// Where something is and how it moves, at the middle of an exposure.
struct MotionState {
  Pose pose;
  /// [linear; angular], m/s and rad/s, both expressed in the frame on the right of `pose`.
  Vector6d velocity = Vector6d::Zero();
  /// Change of `velocity` along the path, m/s^2 and rad/s^2; only what the exposure itself needs.
  Vector6d acceleration = Vector6d::Zero();
};

/// `state` with its pose perturbed on the right and its velocity changed by `step`: [pose; velocity].
MotionState moved(const MotionState& state, const Vector12d& step);
/// The step from `from` to `to`, so that moved(from, difference(from, to)) is `to` with the acceleration of
/// `from`.
Vector12d difference(const MotionState& from, const MotionState& to);

/// The pose dt_s later: the origin moves on straight, the rotation about its own axis. A thrown body does so;
/// the helix of a constant twist would curve the path of whatever spins.
Pose pose_after(const MotionState& state, double dt_s);

/// State of constant velocity, dt_s later: the linear velocity keeps its direction in the frame on the left.
MotionState predict(const MotionState& state, double dt_s);

/// A state and its covariance, of [right perturbation of the pose; change of the velocity].
struct MotionBelief {
  MotionState mean;
  Matrix12d covariance = Matrix12d::Zero();
};

/// How far from what the belief expects, in its standard deviations (Mahalanobis): of pose and velocity
/// together, or of the pose alone. Infinite, or no number, where the covariance has no inverse.
double distance(const MotionBelief& belief, const MotionState& state);
double distance(const MotionBelief& belief, const Pose& pose);

/// Integrated white acceleration (Bar-Shalom, Li, Kirubarajan, "Estimation with Applications to Tracking and
/// Navigation", 2001, 6.2.2), in its spectral densities.
struct MotionNoise {
  double linear_m2_per_s3 = 7.5;     ///< 0.5 m/s of change between frames of 30 Hz.
  double angular_rad2_per_s3 = 120;  ///< 2 rad/s of change between frames of 30 Hz.
};

/// The belief dt_s later. Requires dt_s >= 0.
MotionBelief predict(const MotionBelief& belief, const MotionNoise& noise, double dt_s);

}  // namespace apriltrack
