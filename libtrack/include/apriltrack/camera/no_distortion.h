#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace apriltrack {

/// The ideal pinhole: a point (X, Y, Z) is seen at (X/Z, Y/Z).
///
/// Every lens model has these members: coefficients(), distort() from a point of the camera frame (any unit)
/// to the distorted image plane at unit distance, and undistort() back to a unit ray. Both answer nullopt
/// outside the model's valid domain, and never a NaN. distort_continued() is the bare formula, which knows no
/// domain, of a point (X/Z, Y/Z) of the image plane.
class NoDistortion {
 public:
  std::vector<double> coefficients() const { return {}; }

  /// Valid domain: Z > 0.  jacobian: d result / d point, if asked.
  std::optional<Eigen::Vector2d> distort(const Eigen::Vector3d& point_camera,
                                         Eigen::Matrix<double, 2, 3>* jacobian = nullptr) const;
  std::optional<Eigen::Vector3d> undistort(const Eigen::Vector2d& distorted) const;
  Eigen::Vector2d distort_continued(const Eigen::Vector2d& undistorted) const { return undistorted; }
};

}  // namespace apriltrack
