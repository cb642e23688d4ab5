#include "apriltrack/geometry/homography.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>
#include <numbers>

#include "apriltrack/base/check.h"

namespace apriltrack {
namespace {

// Smallest ratio of the second smallest singular value to the largest at which the null space is taken for a
// line; of four points, the least determinant of three of them and the least share of each in the fourth
// (normalised): well above rounding (1e-16), well below what a real view gives (1e-3 for a tag seen at 85
// degrees).
constexpr double kMinSingularRatio = 1e-9;

/// The similarity that moves the points' mean to 0 and their mean distance from it to sqrt(2).
std::optional<Eigen::Matrix3d> normalisation(std::span<const Eigen::Vector2d> points) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& point : points) mean += point;
  mean /= static_cast<double>(points.size());
  double mean_distance = 0.0;
  for (const Eigen::Vector2d& point : points) mean_distance += (point - mean).norm();
  mean_distance /= static_cast<double>(points.size());
  if (!std::isfinite(mean_distance) || !(mean_distance > 0.0)) return std::nullopt;
  const double scale = std::numbers::sqrt2 / mean_distance;
  Eigen::Matrix3d m;
  m << scale, 0.0, -scale * mean.x(), 0.0, scale, -scale * mean.y(), 0.0, 0.0, 1.0;
  return m;
}

using NormalisedPoints = Eigen::Matrix<double, 3, Eigen::Dynamic>;  ///< Homogeneous, one a column.

NormalisedPoints normalised(std::span<const Eigen::Vector2d> points, const Eigen::Matrix3d& normalisation) {
  NormalisedPoints result(3, static_cast<Eigen::Index>(points.size()));
  for (Eigen::Index i = 0; i < result.cols(); ++i)
    result.col(i) = normalisation * points[static_cast<std::size_t>(i)].homogeneous();
  return result;
}

/// What takes the unit vectors, and their sum, to four points (Hartley and Zisserman, section 2.2, a
/// projective basis); none where three of them lie on a line.
std::optional<Eigen::Matrix3d> basis_of(const NormalisedPoints& points) {
  const Eigen::Matrix3d first = points.leftCols<3>();
  if (!(std::abs(first.determinant()) > kMinSingularRatio)) return std::nullopt;
  const Eigen::Vector3d shares = first.inverse() * points.col(3);
  if (!(shares.cwiseAbs().minCoeff() > kMinSingularRatio)) return std::nullopt;
  return first * shares.asDiagonal();
}

/// Of four points: exactly.
std::optional<Eigen::Matrix3d> through_four(const NormalisedPoints& plane, const NormalisedPoints& image) {
  const auto from = basis_of(plane), to = basis_of(image);
  if (!from || !to) return std::nullopt;
  const Eigen::Matrix3d H = *to * from->inverse();
  return H / H.norm();
}

/// Of more: what makes the algebraic errors least (the same, algorithm 4.2).
std::optional<Eigen::Matrix3d> least_algebraic(const NormalisedPoints& plane, const NormalisedPoints& image) {
  Eigen::MatrixXd equations = Eigen::MatrixXd::Zero(2 * plane.cols(), 9);
  for (Eigen::Index i = 0; i < plane.cols(); ++i) {
    const Eigen::RowVector3d p = plane.col(i).transpose();
    equations.block<1, 3>(2 * i, 0) = p;
    equations.block<1, 3>(2 * i, 6) = -image(0, i) * p;
    equations.block<1, 3>(2 * i + 1, 3) = p;
    equations.block<1, 3>(2 * i + 1, 6) = -image(1, i) * p;
  }
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(equations, Eigen::ComputeFullV);
  const auto& singular_values = svd.singularValues();
  if (!(singular_values(7) > kMinSingularRatio * singular_values(0))) return std::nullopt;
  const Eigen::Matrix<double, 9, 1> h = svd.matrixV().col(8);
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(h.data());
}

}  // namespace

std::optional<Eigen::Matrix3d> estimate_homography(std::span<const Eigen::Vector2d> plane_points,
                                                   std::span<const Eigen::Vector2d> image_points) {
  APRILTRACK_CHECK(plane_points.size() == image_points.size(),
                   "a homography needs as many image as plane points");
  if (plane_points.size() < 4) return std::nullopt;
  const auto N_plane = normalisation(plane_points);
  const auto N_image = normalisation(image_points);
  if (!N_plane || !N_image) return std::nullopt;

  const NormalisedPoints plane = normalised(plane_points, *N_plane);
  const NormalisedPoints image = normalised(image_points, *N_image);
  const auto H_normalised = plane.cols() == 4 ? through_four(plane, image) : least_algebraic(plane, image);
  if (!H_normalised) return std::nullopt;
  // The mean plane point is the normalised origin, so the sign is that of the last entry.
  const double sign = (*H_normalised)(2, 2) < 0.0 ? -1.0 : 1.0;
  const Eigen::Matrix3d H = sign * N_image->inverse() * *H_normalised * *N_plane;
  if (!H.allFinite()) return std::nullopt;
  const double determinant = H_normalised->determinant();
  if (!(std::abs(determinant) > kMinSingularRatio)) return std::nullopt;
  return Eigen::Matrix3d(H / H.norm());
}

}  // namespace apriltrack
