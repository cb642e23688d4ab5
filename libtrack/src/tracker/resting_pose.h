#pragma once

#include <optional>

#include "apriltrack/geometry/pose.h"

namespace apriltrack {

/// The mean of frame after frame, as long as nothing moves: a Kalman filter of a pose that wanders by a tenth
/// of a frame's own noise. What moves, even by a fraction of that noise from frame to frame, starts it anew.
class RestingPose {
 public:
  /// One frame more. covariance: of the noise of this frame alone, not of errors that all frames share; of
  /// the right perturbation of the pose, positive definite. None before a few frames agree. Less noisy than
  /// the frame's own; but a drift that hardly shows may make it lag by as much as the frame's noise, which so
  /// remains what is known of it.
  std::optional<Pose> add(const Pose& pose, const Matrix6d& covariance);
  /// The next frame is the first.
  void forget() { num_frames_ = 0; }

 private:
  void start(const Pose& pose, const Matrix6d& covariance);
  /// Whether the frame, so far off, is one more of a pose at rest.
  bool agrees(const Vector6d& off, const Matrix6d& covariance);

  Pose mean_;
  Matrix6d covariance_ = Matrix6d::Identity();
  Vector6d drift_ =
      Vector6d::Zero();  ///< Of late, what frames are off by in their standard deviations, on the average.
  int num_frames_ = 0;
};

}  // namespace apriltrack
