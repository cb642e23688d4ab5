#pragma once

#include <Eigen/Core>

#include "apriltrack/geometry/rotation.h"

namespace apriltrack {

/// d pixel / d xi of the image of a point under T_camera_a * exp(xi), xi = [translation; rotation] in frame
/// a.
///
/// point_a: the point in frame a. pixel_by_point_a: d pixel / d point_a, that is CameraModel::project's
/// derivative times the rotation matrix of T_camera_a. With the camera's own frame as a, point and derivative
/// as project() has them, xi perturbs the view on its LEFT: exp(xi) * T_camera_map.
inline Eigen::Matrix<double, 2, 6> pixel_jacobian(const Eigen::Matrix<double, 2, 3>& pixel_by_point_a,
                                                  const Eigen::Vector3d& point_a) {
  // exp(xi) moves the point by v + w x point.
  Eigen::Matrix<double, 2, 6> jacobian;
  jacobian << pixel_by_point_a, -pixel_by_point_a * skew(point_a);
  return jacobian;
}

}  // namespace apriltrack
