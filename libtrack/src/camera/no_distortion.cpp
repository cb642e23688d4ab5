#include "apriltrack/camera/no_distortion.h"

#include <Eigen/Geometry>

namespace apriltrack {

std::optional<Eigen::Vector2d> NoDistortion::distort(const Eigen::Vector3d& point_camera,
                                                     Eigen::Matrix<double, 2, 3>* jacobian) const {
  const double z = point_camera.z();
  if (!(z > 0.0)) return std::nullopt;
  const Eigen::Vector2d seen = point_camera.head<2>() / z;
  if (!seen.allFinite()) return std::nullopt;
  if (jacobian) {
    *jacobian << 1.0 / z, 0.0, -seen.x() / z,  //
        0.0, 1.0 / z, -seen.y() / z;
  }
  return seen;
}

std::optional<Eigen::Vector3d> NoDistortion::undistort(const Eigen::Vector2d& distorted) const {
  if (!distorted.allFinite()) return std::nullopt;
  return distorted.homogeneous().stableNormalized();
}

}  // namespace apriltrack
