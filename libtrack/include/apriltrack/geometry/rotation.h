#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace apriltrack {

/// The matrix with `skew(a) * b = a x b`.
Eigen::Matrix3d skew(const Eigen::Vector3d& vector);

/// Rotation by |rotation_vector| about its direction.
Eigen::Quaterniond rotation_exp(const Eigen::Vector3d& rotation_vector);
/// Inverse of rotation_exp, angle in [0, pi]; q and -q give the same answer.
Eigen::Vector3d rotation_log(const Eigen::Quaterniond& rotation);

/// Rz(yaw) Ry(pitch) Rx(roll): about axes that stand still, x first; what URDF, SDF, ROS and RTAB-Map call
/// rpy.
Eigen::Quaterniond rotation_of_roll_pitch_yaw(const Eigen::Vector3d& roll_pitch_yaw_rad);
/// Its inverse: roll, pitch in [-pi/2, pi/2], yaw. To rounding at the poles, too, where roll and yaw are one.
Eigen::Vector3d roll_pitch_yaw_of(const Eigen::Quaterniond& rotation);

/// The rotation next to a matrix, in the sense of least squares over its nine numbers: of one whose numbers
/// are rounded, and of Kabsch's sum of products. Never a mirror image.
Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& matrix);

/// Left Jacobian of SO(3): `exp(w + dw) = exp(J dw) * exp(w)` to first order; also the map from the
/// translation part of a twist to the translation of its exponential.
Eigen::Matrix3d rotation_left_jacobian(const Eigen::Vector3d& rotation_vector);
Eigen::Matrix3d rotation_left_jacobian_inverse(const Eigen::Vector3d& rotation_vector);

}  // namespace apriltrack
