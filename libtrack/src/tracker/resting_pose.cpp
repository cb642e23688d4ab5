#include "resting_pose.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>

namespace apriltrack {
namespace {

constexpr int kLeastFrames = 5;
/// Of a frame's noise, between frames: some twenty of them are averaged.
constexpr double kWander = 0.1;
/// The innovation's square, of six numbers: one frame in a thousand at rest is beyond.
constexpr double kMaxSquare = 22.5;
/// Of the mean innovation, that of the last frame.
constexpr double kDriftShare = 1.0 / 8.0;

}  // namespace

std::optional<Pose> RestingPose::add(const Pose& pose, const Matrix6d& covariance) {
  if (num_frames_ > 0) covariance_ += kWander * kWander * covariance;
  const Vector6d off = (mean_.inverse() * pose).log();
  if (num_frames_ == 0 || !agrees(off, covariance_ + covariance)) {
    start(pose, covariance);
    return std::nullopt;
  }
  const Matrix6d gain = covariance_ * (covariance_ + covariance).inverse();
  mean_ = mean_ * Pose::exp(gain * off);
  covariance_ = gain * covariance;
  covariance_ = 0.5 * (covariance_ + covariance_.transpose()).eval();
  if (++num_frames_ < kLeastFrames) return std::nullopt;
  return mean_;
}

void RestingPose::start(const Pose& pose, const Matrix6d& covariance) {
  mean_ = pose;
  covariance_ = covariance;
  drift_.setZero();
  num_frames_ = 1;
}

bool RestingPose::agrees(const Vector6d& off, const Matrix6d& covariance) {
  const Eigen::LLT<Matrix6d> factor(covariance);
  if (factor.info() != Eigen::Success) return false;
  const Vector6d sigmas = factor.matrixL().solve(off);
  drift_ += kDriftShare * (sigmas - drift_);
  const double variance = kDriftShare / (2.0 - kDriftShare);  // of the mean of independent ones
  return sigmas.squaredNorm() <= kMaxSquare && drift_.squaredNorm() <= kMaxSquare * variance;
}

}  // namespace apriltrack
