#include "pictures/plane_ray.h"

#include <Eigen/Geometry>

namespace apriltrack {

PlanePoint TagPlane::meet(const Eigen::Vector2d& ray) const {
  const Eigen::Vector3d direction = ray.homogeneous();
  const Eigen::Vector3d normal = R_.col(2);
  const Eigen::Vector3d point = normal.dot(t_) / normal.dot(direction) * direction;
  return {(R_.transpose() * (point - t_)).head<2>() / half_size_m_, point};
}

/// As the plane moves by p = rho + theta x point, its point under the ray moves by -p in it, and along the
/// ray as far as it takes to stay in the plane.
Eigen::Matrix<double, 1, 6> TagPlane::by_pose(const Eigen::Vector2d& ray, const PlanePoint& at,
                                              const PatternSample& sample) const {
  const Eigen::Vector3d direction = ray.homogeneous();
  const Eigen::Vector3d along = sample.by_u * R_.col(0) + sample.by_v * R_.col(1);
  const Eigen::Vector3d by_move =
      (along.dot(direction) / R_.col(2).dot(direction) * R_.col(2) - along) / half_size_m_;
  Eigen::Matrix<double, 1, 6> by_pose;
  by_pose << by_move.transpose(), at.point_camera.cross(by_move).transpose();
  return by_pose;
}

}  // namespace apriltrack
