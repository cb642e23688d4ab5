#include "seen_turn.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "apriltrack/geometry/rotation.h"

namespace apriltrack {
namespace {

constexpr double kMaxSigmas = 5.0;
/// Of what a way looks like as a turn: things stand nearer and farther than the tags.
constexpr double kDepthSigma = 0.7;

}  // namespace

MotionBelief predicted(const MotionBelief& belief, const MotionStep& step) {
  MotionBelief result = predict(belief, step.noise, step.dt_s);
  const Vector6d off = step.speed_sigma * step.dt_s * result.mean.velocity;
  result.covariance.topLeftCorner<6, 6>() += off * off.transpose();
  return result;
}

TurnedBelief turned_by(const MotionBelief& before, const MotionStep& step, const SeenTurn& seen) {
  // What is seen is the way since: where the camera was before is no part of it, and is known better only as
  // far as it is tied to the velocity.
  const MotionBelief alone = predicted(before, step);
  MotionBelief from_here = before;
  from_here.covariance.leftCols<6>().setZero();
  const Matrix12d with_way = predicted(from_here, step).covariance;  // of the state now, and the way to it
  from_here.covariance.topRows<6>().setZero();
  const MotionBelief since = predicted(from_here, step);

  const Pose way = before.mean.pose.inverse() * alone.mean.pose;
  // A point p ahead moves by -t where the camera goes by t: as if it had turned by p x t / |p|^2.
  const Eigen::Matrix3d turn_by_way = skew(seen.scene_camera) / seen.scene_camera.squaredNorm();
  const Eigen::Vector3d expected = rotation_log(way.rotation()) + turn_by_way * way.translation();
  const Eigen::Vector3d off = rotation_log(seen.turn.R_before_now) - expected;
  Eigen::Matrix<double, 3, 12> by_state = Eigen::Matrix<double, 3, 12>::Zero();
  by_state.block<3, 3>(0, 0) = turn_by_way * way.rotation();
  by_state.block<3, 3>(0, 3).setIdentity();

  TurnedBelief result{alone, alone.mean.velocity};
  const Eigen::Matrix<double, 12, 3> cross = with_way * by_state.transpose();
  const Eigen::Vector3d by_depth = kDepthSigma * turn_by_way * way.translation();
  const Eigen::Matrix3d covariance = by_state * since.covariance * by_state.transpose() +
                                     by_depth * by_depth.transpose() +
                                     seen.turn.sigma_rad * seen.turn.sigma_rad * Eigen::Matrix3d::Identity();
  const Eigen::LDLT<Eigen::Matrix3d> factor(covariance);
  const double sigmas2 = off.dot(factor.solve(off));
  result.log_likelihood =
      -0.5 * (std::min(sigmas2, kMaxSigmas * kMaxSigmas) + factor.vectorD().array().log().sum());
  result.is_believed = sigmas2 < kMaxSigmas * kMaxSigmas;
  if (result.is_believed) {
    result.belief.mean = moved(alone.mean, cross * factor.solve(off));
    result.belief.covariance -= cross * factor.solve(cross.transpose());
  }
  return result;
}

}  // namespace apriltrack
