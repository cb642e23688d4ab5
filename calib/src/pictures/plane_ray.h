#pragma once

#include <Eigen/Core>

#include "apriltrack/geometry/pose.h"
#include "apriltrack/tags/blurred_pattern.h"

namespace apriltrack {

/// Where a ray meets a tag's plane.
struct PlanePoint {
  Eigen::Vector2d uv;            ///< In half tag sizes.
  Eigen::Vector3d point_camera;  ///< Metres.
};

/// A tag's plane as rays (x / z, y / z) of the camera meet it.
class TagPlane {
 public:
  TagPlane(const Pose& T_camera_tag, double half_size_m)
      : R_(T_camera_tag.rotation_matrix()), t_(T_camera_tag.translation()), half_size_m_(half_size_m) {}

  PlanePoint meet(const Eigen::Vector2d& ray) const;
  /// How the light at `at` under the ray changes, by a left perturbation of T_camera_tag.
  Eigen::Matrix<double, 1, 6> by_pose(const Eigen::Vector2d& ray, const PlanePoint& at,
                                      const PatternSample& sample) const;

 private:
  Eigen::Matrix3d R_;
  Eigen::Vector3d t_;
  double half_size_m_;
};

}  // namespace apriltrack
