#include "apriltrack/camera/equidistant.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "apriltrack/base/error.h"
#include "check_coefficients.h"
#include "root_finding.h"

namespace apriltrack {

EquidistantDistortion::EquidistantDistortion(const std::vector<double>& coefficients) {
  if (coefficients.size() != 4) {
    throw invalid_input("EquidistantDistortion",
                        fmt::format("takes 4 coefficients (there are {})", coefficients.size()));
  }
  check_coefficients(coefficients, "EquidistantDistortion");
  std::copy(coefficients.begin(), coefficients.end(), values_.begin());
  const auto [k1, k2, k3, k4] = values_;
  const Polynomial slope = {1.0, 0.0, 3.0 * k1, 0.0, 5.0 * k2, 0.0, 7.0 * k3, 0.0, 9.0 * k4};
  const auto fold_rad = first_nonpositive(slope, std::numbers::pi);
  max_angle_rad_ = fold_rad ? kInsideFold * *fold_rad : std::numbers::pi;
  max_distorted_angle_ = distorted_angle(max_angle_rad_);
}

double EquidistantDistortion::distorted_angle(double angle_rad) const {
  const auto [k1, k2, k3, k4] = values_;
  const double s = angle_rad * angle_rad;
  return angle_rad * (1.0 + s * (k1 + s * (k2 + s * (k3 + s * k4))));
}

double EquidistantDistortion::distorted_angle_slope(double angle_rad) const {
  const auto [k1, k2, k3, k4] = values_;
  const double s = angle_rad * angle_rad;
  return 1.0 + s * (3.0 * k1 + s * (5.0 * k2 + s * (7.0 * k3 + s * 9.0 * k4)));
}

std::optional<Eigen::Vector2d> EquidistantDistortion::distort(const Eigen::Vector3d& point_camera,
                                                              Eigen::Matrix<double, 2, 3>* jacobian) const {
  const double distance = point_camera.stableNorm();
  if (!(distance > 0.0) || !std::isfinite(distance)) return std::nullopt;
  // On the unit sphere nothing over- or underflows that matters.
  const Eigen::Vector3d ray = point_camera / distance;
  const double radius = std::hypot(ray.x(), ray.y());
  const double angle_rad = std::atan2(radius, ray.z());
  if (!(angle_rad < max_angle_rad_)) return std::nullopt;
  const bool is_on_axis = radius == 0.0;
  const Eigen::Vector2d direction =
      is_on_axis ? Eigen::Vector2d::Zero() : Eigen::Vector2d(ray.head<2>() / radius);
  const double angle_seen = distorted_angle(angle_rad);
  if (jacobian) {
    // Along the direction theta_d changes, across it the direction itself turns.
    const double slope = distorted_angle_slope(angle_rad);
    const double across = is_on_axis ? 1.0 : angle_seen / radius;
    const Eigen::Matrix2d along = direction * direction.transpose();
    jacobian->leftCols<2>() =
        (across * (Eigen::Matrix2d::Identity() - along) + slope * ray.z() * along) / distance;
    jacobian->col(2) = -slope * radius / distance * direction;
  }
  return angle_seen * direction;
}

Eigen::Vector2d EquidistantDistortion::distort_continued(const Eigen::Vector2d& undistorted) const {
  const double radius = undistorted.norm();
  if (radius == 0.0) return undistorted;
  return distorted_angle(std::atan(radius)) / radius * undistorted;
}

std::optional<Eigen::Vector3d> EquidistantDistortion::undistort(const Eigen::Vector2d& distorted) const {
  const double angle_seen = distorted.stableNorm();
  if (!(angle_seen < max_distorted_angle_)) return std::nullopt;
  if (angle_seen == 0.0) return Eigen::Vector3d::UnitZ();
  const double angle_rad = solve_rising([&](double angle) { return distorted_angle(angle); },
                                        [&](double angle) { return distorted_angle_slope(angle); },
                                        angle_seen, 0.0, max_angle_rad_, angle_seen);
  const Eigen::Vector2d direction = distorted / angle_seen;
  return Eigen::Vector3d(std::sin(angle_rad) * direction.x(), std::sin(angle_rad) * direction.y(),
                         std::cos(angle_rad));
}

}  // namespace apriltrack
