#pragma once

#include <Eigen/Core>

#include "apriltrack/tags/blurred_pattern.h"

namespace apriltrack {

// What the fits of a tag's picture have in common: fourteen unknowns of place (8), blur (3) and bend (3), in
// the order of pattern_model.h, and steps of them.

using Vector8d = Eigen::Matrix<double, 8, 1>;
using Matrix8d = Eigen::Matrix<double, 8, 8>;
inline constexpr int kNumShapeUnknowns = 14;

/// How far the corners move in the plane (x0 y0 x1 ...) by each of the eight generators, in half tag sizes.
const Matrix8d& corner_moves();

/// How far a step moves the corner's coordinate that it moves most, in half tag sizes.
double largest_corner_move(const Vector8d& step);

/// The map after a step, to first order what the generators do, scaled to a norm of one.
Eigen::Matrix3d moved_plane(const Eigen::Matrix3d& tag_from_straight, const Vector8d& step);

/// A blur after a change (xx, xy, yy) no larger than itself, its axes' standard deviations between the two.
/// px^2 and px.
Eigen::Matrix2d changed_blur(const Eigen::Matrix2d& blur_px2, const Eigen::Vector3d& change_px2,
                             double min_blur_px, double max_blur_px);

/// Derivatives of what is sampled at (u, v) of the tag's plane, black 0 and white 1. J: of (u, v) by the
/// straightened place, which lies `out` of the tag's middle.
inline Eigen::Matrix<double, kNumShapeUnknowns, 1> by_shape(const PatternSample& sample, double u, double v,
                                                            const Eigen::Matrix2d& J,
                                                            const Eigen::Vector2d& out) {
  const double by_u = sample.by_u, by_v = sample.by_v, radial = u * by_u + v * by_v;
  const Eigen::Matrix2d cross = J.col(0) * J.col(1).transpose();
  const Eigen::Vector2d gradient = J.transpose() * Eigen::Vector2d(by_u, by_v);
  const double r2 = out.squaredNorm();
  Eigen::Matrix<double, kNumShapeUnknowns, 1> by;
  by << by_u, by_v, u * by_u, v * by_u, u * by_v, v * by_v, u * radial, v * radial,
      sample.by_covariance(J.col(0) * J.col(0).transpose()), sample.by_covariance(cross + cross.transpose()),
      sample.by_covariance(J.col(1) * J.col(1).transpose()), -r2 * gradient, -r2 * out.dot(gradient);
  return by;
}

}  // namespace apriltrack
