#include "blur_covariance.h"

#include <Eigen/Cholesky>
#include <vector>

#include "map_uncertainty.h"
#include "pixels_by_pose.h"
#include "pose_adjustment.h"
#include "shared_error.h"

namespace apriltrack {
namespace {

/// Of the largest information, so that what is seen from one side alone leaves a covariance too.
constexpr double kLeastShare = 1e-12;

/// J' J / sigma^2 of a tag's corners, J by the right perturbation of the pose.
Matrix6d shared_information(const PhotometricWorld& world, const PixelsByPose& pixels,
                            const TagEvidence& evidence) {
  const double explained = evidence.clean_correlation() * evidence.clean_correlation();
  const double sigma_px = shared_sigma_px(evidence.path_px, 1.0 - explained);
  Matrix6d information = Matrix6d::Zero();
  for (const Eigen::Vector3d& corner : corners_in_map(world.tag_at(evidence.tag_index).tag)) {
    const auto by_pose = pixels.of(corner);
    if (!by_pose) continue;
    const PixelJacobian J = *by_pose / sigma_px;
    information += J.transpose() * J;
  }
  return information;
}

}  // namespace

Matrix12d fit_covariance(const PhotometricWorld& world, const MotionFit& fit) {
  Matrix12d covariance = fit.information.ldlt().solve(Matrix12d::Identity());
  const PixelsByPose pixels(world, fit.state.pose);
  Matrix6d shared = Matrix6d::Zero();
  for (const TagEvidence& evidence : explained_tags(fit.tags))
    shared += shared_information(world, pixels, evidence);
  if (!fit.tags.empty()) {
    shared.diagonal().array() += kLeastShare * shared.diagonal().maxCoeff();
    covariance.topLeftCorner<6, 6>() += shared.ldlt().solve(Matrix6d::Identity());
  }
  return 0.5 * (covariance + covariance.transpose());
}

Matrix6d map_covariance(const PhotometricWorld& world, const MotionFit& fit) {
  const std::vector<TagEvidence> tags = explained_tags(fit.tags);
  std::vector<TagObservation> seen(tags.size());
  std::vector<const TagObservation*> observations;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const MapTag& tag = world.tag_at(tags[i].tag_index).tag;
    seen[i].tag = &tag;
    seen[i].corners_map = corners_in_map(tag);
    observations.push_back(&seen[i]);
  }
  const Pose T_camera_map = camera_from_map(fit.state.pose, world.mode);
  const Eigen::LLT<Matrix6d> information(corner_information(world.model, observations, T_camera_map));
  if (seen.empty() || information.info() != Eigen::Success) return Matrix6d::Zero();
  const Matrix6d covariance =
      map_uncertainty(world.model, observations, T_camera_map, information.solve(Matrix6d::Identity()))
          .covariance;
  if (!covariance.allFinite()) return Matrix6d::Zero();
  return pose_covariance_from_camera(T_camera_map, covariance, world.mode);
}

}  // namespace apriltrack
