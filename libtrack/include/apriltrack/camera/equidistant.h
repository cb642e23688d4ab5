#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

namespace apriltrack {

/// The fisheye model of J. Kannala and S. Brandt (PAMI 2006) as Kalibr ("equidistant") and OpenCV ("fisheye")
/// use it.
///
/// With R = sqrt(X^2 + Y^2) and theta = atan2(R, Z), the angle from the axis:
///
///     theta_d  = theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8)
///     (x', y') = theta_d / R * (X, Y)
///
/// Valid domain: theta < max_angle_rad(), the first angle at which theta_d no longer rises, or pi. Points
/// beyond 90 degrees (Z <= 0) are seen as long as they lie below it.
class EquidistantDistortion {
 public:
  /// 4 finite coefficients; throws Error(kInvalidInput) where they are not.
  explicit EquidistantDistortion(const std::vector<double>& coefficients);

  std::vector<double> coefficients() const { return {values_.begin(), values_.end()}; }
  double max_angle_rad() const { return max_angle_rad_; }

  /// jacobian: d result / d point, if asked.
  std::optional<Eigen::Vector2d> distort(const Eigen::Vector3d& point_camera,
                                         Eigen::Matrix<double, 2, 3>* jacobian = nullptr) const;
  /// Unit ray; solved to rounding error.
  std::optional<Eigen::Vector3d> undistort(const Eigen::Vector2d& distorted) const;
  /// Beyond the valid domain, too, where theta_d may fall.
  Eigen::Vector2d distort_continued(const Eigen::Vector2d& undistorted) const;

 private:
  double distorted_angle(double angle_rad) const;
  double distorted_angle_slope(double angle_rad) const;

  std::array<double, 4> values_{};
  double max_angle_rad_ = 0.0;
  double max_distorted_angle_ = 0.0;
};

}  // namespace apriltrack
