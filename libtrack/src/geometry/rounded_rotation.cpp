#include "apriltrack/geometry/rounded_rotation.h"

#include <Eigen/LU>
#include <cmath>

#include "apriltrack/geometry/rotation.h"

namespace apriltrack {

double rotation_defect(const Eigen::Matrix3d& matrix) {
  return (matrix * matrix.transpose() - Eigen::Matrix3d::Identity())
      .cwiseAbs()
      .maxCoeff<Eigen::PropagateNaN>();
}

std::optional<Eigen::Matrix3d> rounded_rotation(const Eigen::Matrix3d& matrix, double tolerance) {
  if (!(rotation_defect(matrix) <= tolerance) || !(matrix.determinant() > 0.0)) return std::nullopt;
  return nearest_rotation(matrix);
}

bool is_rounded_rotation(const Eigen::Quaterniond& quaternion, double tolerance) {
  return std::abs(quaternion.coeffs().stableNorm() - 1.0) <= tolerance;  // false for NaN
}

}  // namespace apriltrack
