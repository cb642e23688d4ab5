#include "place_spread.h"

#include <Eigen/Eigenvalues>
#include <cmath>

#include "pixels_by_pose.h"

namespace apriltrack {

double place_sigma_px(const PhotometricWorld& world, const PhotometricTag& tag, const Pose& pose,
                      const Matrix6d& covariance) {
  const auto J = PixelsByPose(world, pose).of(tag.tag.T_map_tag.translation());
  if (!J) return 0.0;
  const Eigen::Matrix2d spread_px2 = *J * covariance * J->transpose();
  return std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(spread_px2).eigenvalues()[1]);
}

}  // namespace apriltrack
