#include "apriltrack/eval/alignment.h"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "apriltrack/base/check.h"

namespace apriltrack {
namespace {

constexpr double kMinSpread_m = 1e-9;
// Below this ratio of singular values the third axis is noise: the rotation about the line is not seen.
constexpr double kMinSingularRatio = 1e-9;

Eigen::Vector3d centre(std::span<const Pose> poses) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Pose& pose : poses) sum += pose.translation();
  return sum / static_cast<double>(poses.size());
}

/// Sum of reference * estimate^T over what is to be brought together, means taken off.
Eigen::Matrix3d correlation(std::span<const Pose> reference, std::span<const Pose> estimate,
                            double orientation_weight) {
  const Eigen::Vector3d reference_centre = centre(reference);
  const Eigen::Vector3d estimate_centre = centre(estimate);
  Eigen::Matrix3d positions = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d orientations = Eigen::Matrix3d::Zero();
  double squared_distances = 0.0;
  for (std::size_t i = 0; i < reference.size(); ++i) {
    const Eigen::Vector3d p = reference[i].translation() - reference_centre;
    positions += p * (estimate[i].translation() - estimate_centre).transpose();
    orientations += (reference[i].rotation() * estimate[i].rotation().conjugate()).toRotationMatrix();
    squared_distances += p.squaredNorm();
  }
  const double n = static_cast<double>(reference.size());
  const double spread = std::max(std::sqrt(squared_distances / n), kMinSpread_m);
  return positions / (spread * spread) / n + orientation_weight * orientations / n;
}

}  // namespace

std::optional<Pose> align_rigidly(std::span<const Pose> reference, std::span<const Pose> estimate,
                                  double orientation_weight) {
  APRILTRACK_CHECK(reference.size() == estimate.size(), "an alignment takes pairs of poses");
  APRILTRACK_CHECK(!reference.empty(), "an alignment takes at least one pair of poses");
  APRILTRACK_CHECK(orientation_weight >= 0.0, "the weight of orientations must be >= 0");
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(correlation(reference, estimate, orientation_weight),
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Vector3d& singular = svd.singularValues();
  if (!(singular(1) > kMinSingularRatio * singular(0))) return std::nullopt;
  Eigen::Vector3d signs = Eigen::Vector3d::Ones();
  signs(2) = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0 ? -1.0 : 1.0;  // no mirror image
  const Eigen::Matrix3d rotation = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
  return Pose(rotation, centre(reference) - rotation * centre(estimate));
}

}  // namespace apriltrack
