#include "blur_covariance.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <vector>

#include "map_uncertainty.h"
#include "pixels_by_pose.h"
#include "place_spread.h"
#include "pose_adjustment.h"
#include "shared_error.h"

namespace apriltrack {
namespace {

/// Of the largest information, so that what is seen from one side alone leaves a covariance too.
constexpr double kLeastShare = 1e-12;

/// J' J of a tag's corners, J by the right perturbation of the pose.
Matrix6d information_of_corners(const PhotometricWorld& world, const PixelsByPose& pixels, int tag_index) {
  Matrix6d information = Matrix6d::Zero();
  for (const Eigen::Vector3d& corner : corners_in_map(world.tag_at(tag_index).tag)) {
    if (const auto J = pixels.of(corner)) information += J->transpose() * *J;
  }
  return information;
}

/// Invertible, whatever is seen from one side alone.
Matrix6d covariance_of(Matrix6d information) {
  information.diagonal().array() += kLeastShare * information.diagonal().maxCoeff();
  return information.ldlt().solve(Matrix6d::Identity());
}

double unexplained_share(const TagEvidence& evidence) {
  return 1.0 - evidence.clean_correlation() * evidence.clean_correlation();
}

}  // namespace

Matrix12d fit_covariance(const PhotometricWorld& world, const MotionFit& fit) {
  Matrix12d covariance = fit.information.ldlt().solve(Matrix12d::Identity());
  const PixelsByPose pixels(world, fit.state.pose);
  Matrix6d shared = Matrix6d::Zero();
  for (const TagEvidence& evidence : explained_tags(fit.tags)) {
    const double sigma_px = shared_sigma_px(evidence.path_px, unexplained_share(evidence));
    shared += information_of_corners(world, pixels, evidence.tag_index) / (sigma_px * sigma_px);
  }
  if (!fit.tags.empty()) covariance.topLeftCorner<6, 6>() += covariance_of(shared);
  return 0.5 * (covariance + covariance.transpose());
}

Matrix6d cover_covariance(const PhotometricWorld& world, const MotionFit& fit) {
  const std::vector<TagEvidence> tags = explained_tags(fit.tags);
  if (tags.empty()) return Matrix6d::Zero();
  const TagEvidence& lone = *std::ranges::max_element(tags, {}, &TagEvidence::independent_samples);
  double samples = 0.0;
  for (const TagEvidence& tag : tags) samples += tag.independent_samples();
  // As far as it is alone: another that tells as much of the pose confirms it wholly.
  const double share = std::max(0.0, 2.0 - samples / lone.independent_samples());
  const double size_px = tag_size_px(world, world.tag_at(lone.tag_index), fit.state.pose);
  const double sigma_px = share * cover_sigma_px(size_px, unexplained_share(lone));
  if (!(sigma_px > 0.0)) return Matrix6d::Zero();
  const PixelsByPose pixels(world, fit.state.pose);
  return sigma_px * sigma_px * covariance_of(information_of_corners(world, pixels, lone.tag_index));
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
