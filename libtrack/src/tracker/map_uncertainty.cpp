#include "map_uncertainty.h"

#include "apriltrack/camera/pixel_jacobian.h"
#include "apriltrack/tags/tag_corners.h"

namespace apriltrack {
namespace {

/// Of one tag, J = d corners / d xi of T_camera_map * exp(xi) and K = d corners / d eta of T_map_tag *
/// exp(eta), whitened.
struct TagSums {
  Matrix6d tag_tag = Matrix6d::Zero();   ///< K' K
  Matrix6d pose_tag = Matrix6d::Zero();  ///< J' K
};

TagSums sum_over_corners(const CameraModel& model, const TagObservation& observation,
                         const Pose& T_camera_map) {
  using CornerJacobian = Eigen::Matrix<double, 2 * kNumCorners, 6>;
  const Pose T_camera_tag = T_camera_map * observation.tag->T_map_tag;
  const auto corners_tag = tag_corners(observation.tag->size_m);
  CornerJacobian J = CornerJacobian::Zero(), K = CornerJacobian::Zero();
  for (std::size_t i = 0; i < kNumCorners; ++i) {
    Eigen::Matrix<double, 2, 3> d_pixel_d_point;
    if (!model.project(T_camera_map * observation.corners_map[i], &d_pixel_d_point)) continue;
    const auto row = 2 * static_cast<Eigen::Index>(i);
    J.middleRows<2>(row) =
        pixel_jacobian(d_pixel_d_point * T_camera_map.rotation_matrix(), observation.corners_map[i]);
    K.middleRows<2>(row) = pixel_jacobian(d_pixel_d_point * T_camera_tag.rotation_matrix(), corners_tag[i]);
  }
  J = (observation.whitening_per_px * J).eval();
  K = (observation.whitening_per_px * K).eval();
  return {K.transpose() * K, J.transpose() * K};
}

}  // namespace

MapUncertainty map_uncertainty(const CameraModel& model,
                               const std::vector<const TagObservation*>& observations,
                               const Pose& T_camera_map, const Matrix6d& inverse_information) {
  MapUncertainty uncertainty;
  for (const TagObservation* observation : observations) {
    if (!observation->tag->covariance) continue;
    const Matrix6d& covariance = *observation->tag->covariance;
    const TagSums sums = sum_over_corners(model, *observation, T_camera_map);
    const Matrix6d d_pose_d_tag = inverse_information * sums.pose_tag;
    uncertainty.covariance += d_pose_d_tag * covariance * d_pose_d_tag.transpose();
    // |(I - J (J'J)^-1 J') K eta|^2: what the pose cannot take up.
    const Matrix6d left = sums.tag_tag - sums.pose_tag.transpose() * d_pose_d_tag;
    uncertainty.squared_error += (left * covariance).trace();
  }
  return uncertainty;
}

}  // namespace apriltrack
