#include "place_spread.h"

#include <Eigen/Eigenvalues>
#include <cmath>

#include "apriltrack/camera/pixel_jacobian.h"

namespace apriltrack {

double place_sigma_px(const PhotometricWorld& world, const PhotometricTag& tag, const Pose& pose,
                      const Matrix6d& covariance) {
  const Eigen::Vector3d centre = camera_from_map(pose, world.mode) * tag.tag.T_map_tag.translation();
  Eigen::Matrix<double, 2, 3> by_point;
  if (!world.model.project(centre, &by_point)) return 0.0;
  const Eigen::Matrix<double, 2, 6> J = pixel_jacobian(by_point, centre) * view_by_pose(pose, world.mode);
  const Eigen::Matrix2d spread_px2 = J * covariance * J.transpose();
  return std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(spread_px2).eigenvalues()[1]);
}

}  // namespace apriltrack
