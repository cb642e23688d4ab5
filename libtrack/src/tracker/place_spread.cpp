#include "place_spread.h"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>

#include "pixels_by_pose.h"

namespace apriltrack {

double tag_size_px(const PhotometricWorld& world, const PhotometricTag& tag, const Pose& pose) {
  const Pose view = camera_from_map(pose, world.mode);
  return world.focal_px() * tag.tag.size_m / (view * tag.tag.T_map_tag.translation()).norm();
}

double place_sigma_px(const PhotometricWorld& world, const PhotometricTag& tag, const Pose& pose,
                      const Matrix6d& covariance) {
  const auto J = PixelsByPose(world, pose).of(tag.tag.T_map_tag.translation());
  if (!J) return 0.0;
  const Eigen::Matrix2d spread_px2 = *J * covariance * J->transpose();
  return std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(spread_px2).eigenvalues()[1]);
}

double place_shift_px(const PhotometricWorld& world, const PhotometricTag& tag, const Pose& from,
                      const Pose& to) {
  const Eigen::Vector3d centre = tag.tag.T_map_tag.translation();
  const auto before = world.model.project(camera_from_map(from, world.mode) * centre);
  const auto after = world.model.project(camera_from_map(to, world.mode) * centre);
  return before && after ? (*after - *before).norm() : std::numeric_limits<double>::infinity();
}

}  // namespace apriltrack
