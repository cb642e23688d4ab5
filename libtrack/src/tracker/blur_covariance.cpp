#include "blur_covariance.h"

#include <Eigen/Cholesky>
#include <cmath>

namespace apriltrack {
namespace {

constexpr double kSharedSigma_px = 0.03;
constexpr double kSharedSigmaPerBlur = 0.01;

/// J' J / sigma^2 of a tag's corners, J by the right perturbation of the pose.
Matrix6d shared_information(const PhotometricWorld& world, const MotionFit& fit,
                            const TagEvidence& evidence) {
  const double sigma_px = std::hypot(kSharedSigma_px, kSharedSigmaPerBlur * evidence.path_px);
  const Pose view = camera_from_map(fit.state.pose, world.mode);
  const Matrix6d left_by_right =
      world.mode == TrackMode::kEgo ? Matrix6d(-Matrix6d::Identity()) : fit.state.pose.adjoint();
  Matrix6d information = Matrix6d::Zero();
  for (const Eigen::Vector3d& corner :
       corners_in_map(world.tags[static_cast<std::size_t>(evidence.tag_index)].tag)) {
    const Eigen::Vector3d point = view * corner;
    Eigen::Matrix<double, 2, 3> by_point;
    if (!world.model.project(point, &by_point)) continue;
    Eigen::Matrix<double, 2, 6> J;
    J.leftCols<3>() = by_point;
    for (int row = 0; row < 2; ++row)
      J.block<1, 3>(row, 3) = point.cross(Eigen::Vector3d(by_point.row(row).transpose())).transpose();
    J = J * left_by_right / sigma_px;
    information += J.transpose() * J;
  }
  return information;
}

}  // namespace

Matrix12d fit_covariance(const PhotometricWorld& world, const MotionFit& fit) {
  Matrix12d covariance = fit.information.ldlt().solve(Matrix12d::Identity());
  Matrix6d shared = Matrix6d::Zero();
  for (const TagEvidence& evidence : fit.tags) shared += shared_information(world, fit, evidence);
  const Eigen::LDLT<Matrix6d> factor(shared);
  if (!fit.tags.empty() && factor.rcond() > 1e-14)
    covariance.topLeftCorner<6, 6>() += factor.solve(Matrix6d::Identity());
  return 0.5 * (covariance + covariance.transpose());
}

}  // namespace apriltrack
