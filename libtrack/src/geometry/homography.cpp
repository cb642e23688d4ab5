#include "apriltrack/geometry/homography.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "apriltrack/base/check.h"

namespace apriltrack {
namespace {

// Smallest ratio of the second smallest singular value to the largest at which the null space is taken for a
// line: well above rounding (1e-16), well below what a real view gives (1e-3 for a tag seen at 85 degrees).
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

}  // namespace

std::optional<Eigen::Matrix3d> estimate_homography(std::span<const Eigen::Vector2d> plane_points,
                                                   std::span<const Eigen::Vector2d> image_points) {
  APRILTRACK_CHECK(plane_points.size() == image_points.size(),
                   "a homography needs as many image as plane points");
  if (plane_points.size() < 4) return std::nullopt;
  const auto N_plane = normalisation(plane_points);
  const auto N_image = normalisation(image_points);
  if (!N_plane || !N_image) return std::nullopt;

  const auto num_points = static_cast<Eigen::Index>(plane_points.size());
  // At least nine rows, so that the decomposition always has nine singular values.
  Eigen::MatrixXd equations = Eigen::MatrixXd::Zero(std::max<Eigen::Index>(2 * num_points, 9), 9);
  for (Eigen::Index i = 0; i < num_points; ++i) {
    const Eigen::RowVector3d p =
        (*N_plane * plane_points[static_cast<std::size_t>(i)].homogeneous()).transpose();
    const Eigen::Vector3d q = *N_image * image_points[static_cast<std::size_t>(i)].homogeneous();
    equations.block<1, 3>(2 * i, 0) = p;
    equations.block<1, 3>(2 * i, 6) = -q.x() * p;
    equations.block<1, 3>(2 * i + 1, 3) = p;
    equations.block<1, 3>(2 * i + 1, 6) = -q.y() * p;
  }
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(equations, Eigen::ComputeFullV);
  const auto& singular_values = svd.singularValues();
  if (!(singular_values(7) > kMinSingularRatio * singular_values(0))) return std::nullopt;

  const Eigen::Matrix<double, 9, 1> h = svd.matrixV().col(8);
  const Eigen::Matrix3d H_normalised =
      Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(h.data());
  // The mean plane point is the normalised origin, so the sign is that of the last entry.
  const double sign = H_normalised(2, 2) < 0.0 ? -1.0 : 1.0;
  const Eigen::Matrix3d H = sign * N_image->inverse() * H_normalised * *N_plane;
  if (!H.allFinite()) return std::nullopt;
  const double determinant = H_normalised.determinant();
  if (!(std::abs(determinant) > kMinSingularRatio)) return std::nullopt;
  return Eigen::Matrix3d(H / H.norm());
}

}  // namespace apriltrack
