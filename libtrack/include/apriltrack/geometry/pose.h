#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include "apriltrack/base/version.h"

namespace apriltrack {

/// [translation; rotation], metres and radians: the tangent order of the whole project.
using Vector6d = Eigen::Matrix<double, 6, 1>;
/// Covariances and Jacobians in tangent order.
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// A rigid transform. `T_a_b * p_b = p_a`: equal neighbours cancel.
///
/// Perturbations act on the right, `T * exp(xi)`: xi is expressed in the frame on the right
/// (docs/conventions.md).
class Pose {
 public:
  Pose() = default;
  /// rotation need not have unit length; it is normalised here, and its sign is kept. One that has unit
  /// length to rounding stays as it is, so that a pose read back from a file is the same to the last bit.
  Pose(const Eigen::Quaterniond& rotation, const Eigen::Vector3d& translation)
      : rotation_(has_unit_length(rotation) ? rotation : rotation.normalized()), translation_(translation) {}
  /// matrix: a rotation matrix; what is left of scale and skew by rounding is removed.
  Pose(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& translation)
      : Pose(Eigen::Quaterniond(rotation), translation) {}

  static Pose identity() { return {}; }
  /// The exponential map of SE(3): the motion along the constant twist xi for unit time.
  static Pose exp(const Vector6d& xi);

  const Eigen::Quaterniond& rotation() const { return rotation_; }
  const Eigen::Vector3d& translation() const { return translation_; }
  Eigen::Matrix3d rotation_matrix() const { return rotation_.toRotationMatrix(); }
  Eigen::Matrix4d matrix() const;

  Pose operator*(const Pose& other) const {
    return {rotation_ * other.rotation_, rotation_ * other.translation_ + translation_};
  }
  Eigen::Vector3d operator*(const Eigen::Vector3d& point) const { return rotation_ * point + translation_; }
  Pose inverse() const;

  /// The inverse of exp; the rotation part has an angle in [0, pi].
  Vector6d log() const;
  /// Moves a perturbation to the other side: `T * exp(xi) = exp(adjoint(T) * xi) * T`.
  Matrix6d adjoint() const;

  bool is_finite() const { return rotation_.coeffs().allFinite() && translation_.allFinite(); }

 private:
  static bool has_unit_length(const Eigen::Quaterniond& rotation) {
    // Normalising leaves up to 5 epsilon in the squared norm, squaring and summing included.
    constexpr double kRounding = 8.0 * std::numeric_limits<double>::epsilon();
    return std::abs(rotation.squaredNorm() - 1.0) <= kRounding;
  }

  Eigen::Quaterniond rotation_ = Eigen::Quaterniond::Identity();
  Eigen::Vector3d translation_ = Eigen::Vector3d::Zero();
};

/// a at fraction 0, b at fraction 1, along the constant twist between them; fractions outside [0, 1]
/// extrapolate.
Pose interpolate(const Pose& a, const Pose& b, double fraction);

/// Angle between two orientations, in [0, pi].
double rotation_angle_rad(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b);

}  // namespace apriltrack
