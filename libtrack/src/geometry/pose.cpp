#include "apriltrack/geometry/pose.h"

#include "apriltrack/geometry/rotation.h"

namespace apriltrack {

Pose Pose::exp(const Vector6d& xi) {
  const Eigen::Vector3d rotation_vector = xi.tail<3>();
  return {rotation_exp(rotation_vector), rotation_left_jacobian(rotation_vector) * xi.head<3>()};
}

Eigen::Matrix4d Pose::matrix() const {
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.topLeftCorner<3, 3>() = rotation_matrix();
  m.topRightCorner<3, 1>() = translation_;
  return m;
}

Pose Pose::inverse() const {
  const Eigen::Quaterniond inverse_rotation = rotation_.conjugate();
  return {inverse_rotation, -(inverse_rotation * translation_)};
}

Vector6d Pose::log() const {
  Vector6d xi;
  xi.tail<3>() = rotation_log(rotation_);
  xi.head<3>() = rotation_left_jacobian_inverse(xi.tail<3>()) * translation_;
  return xi;
}

Matrix6d Pose::adjoint() const {
  const Eigen::Matrix3d R = rotation_matrix();
  Matrix6d m;
  m << R, skew(translation_) * R, Eigen::Matrix3d::Zero(), R;
  return m;
}

Pose interpolate(const Pose& a, const Pose& b, double fraction) {
  return a * Pose::exp(fraction * (a.inverse() * b).log());
}

double rotation_angle_rad(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
  return rotation_log(a.conjugate() * b).norm();
}

}  // namespace apriltrack
