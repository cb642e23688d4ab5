#include "apriltrack/camera/radtan.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "apriltrack/base/error.h"
#include "apriltrack/camera/no_distortion.h"
#include "check_coefficients.h"
#include "root_finding.h"

namespace apriltrack {
namespace {

/// Beyond, a point is as good as beside the camera; the polynomials stay far from overflow.
constexpr double kLargestRadius = 1000.0;

/// 1 + a s + b s^2 + c s^3 as a polynomial in r, s = r^2.
Polynomial even_polynomial(double a, double b, double c) {
  return {1.0, 0.0, a, 0.0, b, 0.0, c};
}

}  // namespace

RadtanDistortion::RadtanDistortion(const std::vector<double>& coefficients)
    : num_coefficients_(static_cast<int>(coefficients.size())) {
  if (coefficients.size() != 4 && coefficients.size() != 5 && coefficients.size() != 8) {
    throw invalid_input("RadtanDistortion",
                        fmt::format("takes 4, 5 or 8 coefficients (there are {})", coefficients.size()));
  }
  check_coefficients(coefficients, "RadtanDistortion");
  std::copy(coefficients.begin(), coefficients.end(), values_.begin());
  max_radius_ = find_max_radius();
  max_distorted_radius_ = max_radius_ * radial(max_radius_ * max_radius_).factor;
}

double RadtanDistortion::find_max_radius() const {
  const auto [k1, k2, p1, p2, k3, k4, k5, k6] = values_;
  const Polynomial numerator = even_polynomial(k1, k2, k3);
  const Polynomial denominator = even_polynomial(k4, k5, k6);
  const Polynomial squared_denominator = multiply(denominator, denominator);
  const Polynomial tangential = {0.0, 6.0 * std::hypot(p1, p2)};

  double limit = kLargestRadius;
  const auto keep_positive = [&](const Polynomial& polynomial) {
    limit = first_nonpositive(polynomial, limit).value_or(limit);
  };
  keep_positive(denominator);
  // 1000 - r f, times the denominator: a pole shows points at any distance long before it is reached.
  keep_positive(add_scaled(multiply({kLargestRadius}, denominator), -1.0, multiply({0.0, 1.0}, numerator)));
  // f - 6 |p| r, times the denominator.
  keep_positive(add_scaled(numerator, -1.0, multiply(tangential, denominator)));
  // d(r N/D)/dr - 6 |p| r, times D^2:  N D + r (N' D - N D') - 6 |p| r D^2.
  const Polynomial radius = {0.0, 1.0};
  const Polynomial quotient_rule = add_scaled(multiply(derivative(numerator), denominator), -1.0,
                                              multiply(numerator, derivative(denominator)));
  keep_positive(add_scaled(add_scaled(multiply(numerator, denominator), 1.0, multiply(radius, quotient_rule)),
                           -1.0, multiply(tangential, squared_denominator)));
  return limit < kLargestRadius ? limit * kInsideFold : limit;
}

RadtanDistortion::Radial RadtanDistortion::radial(double s) const {
  const auto [k1, k2, p1, p2, k3, k4, k5, k6] = values_;
  const double numerator = 1.0 + s * (k1 + s * (k2 + s * k3));
  const double numerator_slope = k1 + s * (2.0 * k2 + s * 3.0 * k3);
  if (num_coefficients_ < 8) return {numerator, numerator_slope};
  const double denominator = 1.0 + s * (k4 + s * (k5 + s * k6));
  const double denominator_slope = k4 + s * (2.0 * k5 + s * 3.0 * k6);
  const double factor = numerator / denominator;
  return {factor, (numerator_slope - factor * denominator_slope) / denominator};
}

Eigen::Vector2d RadtanDistortion::distort_plane(const Eigen::Vector2d& undistorted,
                                                Eigen::Matrix2d* jacobian) const {
  const double x = undistorted.x();
  const double y = undistorted.y();
  const double p1 = values_[2];
  const double p2 = values_[3];
  const double s = undistorted.squaredNorm();
  const auto [factor, slope] = radial(s);
  if (jacobian) {
    const double mixed = 2.0 * (slope * x * y + p1 * x + p2 * y);
    *jacobian << factor + 2.0 * slope * x * x + 2.0 * p1 * y + 6.0 * p2 * x, mixed,  //
        mixed, factor + 2.0 * slope * y * y + 6.0 * p1 * y + 2.0 * p2 * x;
  }
  return {x * factor + 2.0 * p1 * x * y + p2 * (s + 2.0 * x * x),
          y * factor + p1 * (s + 2.0 * y * y) + 2.0 * p2 * x * y};
}

std::optional<Eigen::Vector2d> RadtanDistortion::distort(const Eigen::Vector3d& point_camera,
                                                         Eigen::Matrix<double, 2, 3>* jacobian) const {
  const auto undistorted = NoDistortion().distort(point_camera, jacobian);
  if (!undistorted || !(undistorted->norm() < max_radius_)) return std::nullopt;
  if (!jacobian) return distort_plane(*undistorted, nullptr);
  Eigen::Matrix2d jacobian_plane;
  const Eigen::Vector2d distorted = distort_plane(*undistorted, &jacobian_plane);
  *jacobian = (jacobian_plane * *jacobian).eval();
  return distorted;
}

double RadtanDistortion::undistort_radius(double distorted_radius) const {
  if (distorted_radius >= max_distorted_radius_) return max_radius_;
  const auto radius_seen = [&](double r) { return r * radial(r * r).factor; };
  const auto slope = [&](double r) {
    const auto [factor, factor_slope] = radial(r * r);
    return factor + 2.0 * r * r * factor_slope;
  };
  return solve_rising(radius_seen, slope, distorted_radius, 0.0, max_radius_, distorted_radius);
}

std::optional<Eigen::Vector2d> RadtanDistortion::undistort_plane(const Eigen::Vector2d& distorted,
                                                                 const Eigen::Vector2d& start) const {
  Eigen::Vector2d plane = start;
  Eigen::Matrix2d jacobian;
  Eigen::Vector2d residual = distort_plane(plane, &jacobian) - distorted;
  // What rounding of the plane's and the picture's coordinates leaves at best.
  const auto rounding = [&] { return 4e-15 * (distorted.norm() + jacobian.norm() * plane.norm()); };
  for (int i = 0; i < 100 && residual.norm() > 0.0; ++i) {
    // Newton's direction leads downhill wherever the Jacobian is regular, which it is in the whole disc.
    Eigen::Vector2d step = -jacobian.inverse() * residual;
    std::optional<Eigen::Vector2d> better;
    for (int halving = 0; halving < 40 && !better; ++halving, step *= 0.5) {
      const Eigen::Vector2d trial = plane + step;
      const bool is_inside = trial.norm() < max_radius_;
      if (is_inside && (distort_plane(trial, nullptr) - distorted).norm() < residual.norm()) better = trial;
      if (is_inside && !better && residual.norm() <= rounding()) return plane;
    }
    if (!better) break;
    plane = *better;
    residual = distort_plane(plane, &jacobian) - distorted;
  }
  if (residual.norm() > rounding()) return std::nullopt;
  return plane;
}

std::optional<Eigen::Vector3d> RadtanDistortion::undistort(const Eigen::Vector2d& distorted) const {
  const double distorted_radius = distorted.stableNorm();
  if (!std::isfinite(distorted_radius)) return std::nullopt;
  if (distorted_radius == 0.0) return Eigen::Vector3d::UnitZ();
  const Eigen::Vector2d direction = distorted / distorted_radius;
  const double radius = undistort_radius(distorted_radius);
  const bool is_radial = values_[2] == 0.0 && values_[3] == 0.0;
  if (is_radial) {
    if (!(radius < max_radius_)) return std::nullopt;
    return (radius * direction).homogeneous().stableNormalized();
  }
  // What the tangential terms add is small: the solution of the radial part is a start inside the disc.
  const auto plane = undistort_plane(distorted, std::min(radius, max_radius_ * (1.0 - 1e-9)) * direction);
  if (!plane) return std::nullopt;
  return plane->homogeneous().stableNormalized();
}

}  // namespace apriltrack
