#include "apriltrack/motion/motion_state.h"

#include <Eigen/Cholesky>
#include <cmath>

#include "apriltrack/base/check.h"
#include "apriltrack/geometry/rotation.h"

namespace apriltrack {
namespace {

Vector6d mean_velocity(const MotionState& state, double dt_s) {
  return state.velocity + 0.5 * dt_s * state.acceleration;
}

/// d next / d state, both in [right perturbation of the pose; change of the velocity].
Matrix12d transition(const MotionState& state, const MotionState& next, double dt_s) {
  const Eigen::Matrix3d turned =
      (next.pose.rotation().conjugate() * state.pose.rotation()).toRotationMatrix();
  // exp(phi + d) = exp(phi) exp(J d), the right Jacobian J.
  const Eigen::Matrix3d dphi = dt_s * rotation_left_jacobian(-dt_s * state.velocity.tail<3>());
  Matrix12d F = Matrix12d::Zero();
  F.block<3, 3>(0, 0) = turned;
  F.block<3, 3>(0, 3) = -dt_s * turned * skew(state.velocity.head<3>());
  F.block<3, 3>(0, 6) = dt_s * turned;
  F.block<3, 3>(3, 3) = turned;
  F.block<3, 3>(3, 9) = dphi;
  F.block<3, 3>(6, 6) = turned;
  F.block<3, 3>(6, 9) = skew(next.velocity.head<3>()) * dphi;
  F.block<3, 3>(9, 9).setIdentity();
  return F;
}

}  // namespace

MotionState moved(const MotionState& state, const Vector12d& step) {
  MotionState next = state;
  next.pose = state.pose * Pose::exp(step.head<6>());
  next.velocity += step.tail<6>();
  return next;
}

Vector12d difference(const MotionState& from, const MotionState& to) {
  Vector12d step;
  step << (from.pose.inverse() * to.pose).log(), to.velocity - from.velocity;
  return step;
}

Pose pose_after(const MotionState& state, double dt_s) {
  const Vector6d step = dt_s * mean_velocity(state, dt_s);
  const Eigen::Quaterniond& rotation = state.pose.rotation();
  return {rotation * rotation_exp(step.tail<3>()), state.pose.translation() + rotation * step.head<3>()};
}

MotionState predict(const MotionState& state, double dt_s) {
  MotionState next;
  next.pose = pose_after(state, dt_s);
  const Eigen::Quaterniond turned = next.pose.rotation().conjugate() * state.pose.rotation();
  next.velocity.head<3>() = turned * state.velocity.head<3>();
  next.velocity.tail<3>() = state.velocity.tail<3>();
  return next;
}

double distance(const MotionBelief& belief, const MotionState& state) {
  const Vector12d off = difference(belief.mean, state);
  return std::sqrt(off.dot(belief.covariance.ldlt().solve(off)));
}

double distance(const MotionBelief& belief, const Pose& pose) {
  const Vector6d off = (belief.mean.pose.inverse() * pose).log();
  return std::sqrt(off.dot(Matrix6d(belief.covariance.topLeftCorner<6, 6>()).ldlt().solve(off)));
}

MotionBelief predict(const MotionBelief& belief, const MotionNoise& noise, double dt_s) {
  APRILTRACK_CHECK(dt_s >= 0.0, "time must not run backwards");
  MotionBelief next;
  next.mean = predict(belief.mean, dt_s);
  const Matrix12d F = transition(belief.mean, next.mean, dt_s);
  next.covariance = F * belief.covariance * F.transpose();
  for (int i = 0; i < 6; ++i) {
    const double density = i < 3 ? noise.linear_m2_per_s3 : noise.angular_rad2_per_s3;
    next.covariance(i, i) += density * dt_s * dt_s * dt_s / 3.0;
    next.covariance(i, i + 6) += density * dt_s * dt_s / 2.0;
    next.covariance(i + 6, i) += density * dt_s * dt_s / 2.0;
    next.covariance(i + 6, i + 6) += density * dt_s;
  }
  return next;
}

}  // namespace apriltrack
