#include "motion_start.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include "pose_adjustment.h"

namespace apriltrack {
namespace {

constexpr double kMaxPriorDistance = 6.0;  // standard deviations of the pose
constexpr double kColdCornerSigma_px = 3.0;
constexpr double kColdLinear_m_per_s = 1.5;
constexpr double kColdAngular_rad_per_s = 6.0;

}  // namespace

std::optional<MotionBelief> cold_belief(const PhotometricWorld& world, const PoseCandidate& candidate) {
  Matrix6d information = Matrix6d::Zero();
  for (const TagObservation* seen : candidate.inliers) {
    const TagObservation vague = with_further_noise(*seen, kColdCornerSigma_px);
    information += corner_information(world.model, {&vague}, candidate.T_camera_map);
  }
  const Eigen::LLT<Matrix6d> factor(information);
  if (factor.info() != Eigen::Success) return std::nullopt;
  Matrix6d covariance = factor.solve(Matrix6d::Identity());
  if (!covariance.allFinite()) return std::nullopt;
  covariance = pose_covariance_from_camera(candidate.T_camera_map, covariance, world.mode);
  MotionBelief belief;
  belief.mean.pose = pose_from_camera(candidate.T_camera_map, world.mode);
  belief.covariance.topLeftCorner<6, 6>() = 0.5 * (covariance + covariance.transpose());
  belief.covariance.diagonal().segment<3>(6).setConstant(kColdLinear_m_per_s * kColdLinear_m_per_s);
  belief.covariance.diagonal().segment<3>(9).setConstant(kColdAngular_rad_per_s * kColdAngular_rad_per_s);
  return belief;
}

std::optional<MotionState> conditioned(const MotionBelief& belief, const Pose& pose) {
  const Vector6d off = (belief.mean.pose.inverse() * pose).log();
  const Vector6d weighted = Matrix6d(belief.covariance.topLeftCorner<6, 6>()).ldlt().solve(off);
  if (!(off.dot(weighted) < kMaxPriorDistance * kMaxPriorDistance)) return std::nullopt;
  MotionState state = belief.mean;
  state.pose = pose;
  state.velocity += belief.covariance.bottomLeftCorner<6, 6>() * weighted;
  return state;
}

Pose mirrored_tilt(const Pose& T_camera_tag) {
  const Eigen::Quaterniond to_sight =
      Eigen::Quaterniond::FromTwoVectors(T_camera_tag.translation(), Eigen::Vector3d::UnitZ());
  const Eigen::DiagonalMatrix<double, 3> D(1.0, 1.0, -1.0);
  const Eigen::Matrix3d mirrored = D * (to_sight * T_camera_tag.rotation()).toRotationMatrix() * D;
  return {to_sight.conjugate() * Eigen::Quaterniond(mirrored), T_camera_tag.translation()};
}

MotionState mirrored_state(const MotionState& state, const Pose& T_map_tag, TrackMode mode) {
  const Pose view = camera_from_map(state.pose, mode);
  const Pose T_camera_tag = view * T_map_tag;
  MotionState other;
  other.pose = pose_from_camera(mirrored_tilt(T_camera_tag) * T_map_tag.inverse(), mode);
  const Vector6d rate = view_by_pose(state.pose, mode) * state.velocity;  // in the camera's frame
  const Eigen::Vector3d centre = T_camera_tag.translation(), sight = centre.normalized();
  const Eigen::Vector3d turn = rate.tail<3>(), other_turn = 2.0 * turn.dot(sight) * sight - turn;
  Vector6d other_rate;
  other_rate << rate.head<3>() + turn.cross(centre) - other_turn.cross(centre), other_turn;
  other.velocity = view_by_pose(other.pose, mode).partialPivLu().solve(other_rate);
  return other;
}

}  // namespace apriltrack
