#include "apriltrack/geometry/rotation.h"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>

namespace apriltrack {
namespace {

// Below this angle the series are exact to double precision: their first dropped term is angle^4 / 120 <
// 1e-17.
constexpr double kSmallAngle_rad = 1e-4;

}  // namespace

Eigen::Matrix3d skew(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return m;
}

Eigen::Quaterniond rotation_exp(const Eigen::Vector3d& rotation_vector) {
  const double angle = rotation_vector.norm();
  const double half = 0.5 * angle;
  const double scale = angle < kSmallAngle_rad ? 0.5 - angle * angle / 48.0 : std::sin(half) / angle;
  Eigen::Quaterniond q;
  q.w() = std::cos(half);
  q.vec() = scale * rotation_vector;
  return q.normalized();
}

Eigen::Vector3d rotation_log(const Eigen::Quaterniond& rotation) {
  const double sign = rotation.w() < 0.0 ? -1.0 : 1.0;
  const double sine = rotation.vec().norm();
  const double cosine = sign * rotation.w();
  // atan2 keeps full precision near 0 and near pi, where acos and asin lose half of the digits.
  const double scale = sine < kSmallAngle_rad ? 2.0 / cosine * (1.0 - sine * sine / (3.0 * cosine * cosine))
                                              : 2.0 * std::atan2(sine, cosine) / sine;
  return sign * scale * rotation.vec();
}

Eigen::Matrix3d rotation_left_jacobian(const Eigen::Vector3d& w) {
  const double angle_squared = w.squaredNorm();
  const double angle = std::sqrt(angle_squared);
  const bool is_small = angle < kSmallAngle_rad;
  const double half_sine = std::sin(0.5 * angle);  // 2 sin^2(x/2) keeps the digits that 1 - cos(x) loses
  const double a = is_small ? 0.5 - angle_squared / 24.0 : 2.0 * half_sine * half_sine / angle_squared;
  const double b =
      is_small ? 1.0 / 6.0 - angle_squared / 120.0 : (angle - std::sin(angle)) / (angle_squared * angle);
  const Eigen::Matrix3d W = skew(w);
  return Eigen::Matrix3d::Identity() + a * W + b * W * W;
}

Eigen::Matrix3d rotation_left_jacobian_inverse(const Eigen::Vector3d& w) {
  const double angle = w.norm();
  const double half = 0.5 * angle;
  const double c = angle < kSmallAngle_rad ? 1.0 / 12.0 + angle * angle / 720.0
                                           : (1.0 - half * std::cos(half) / std::sin(half)) / (angle * angle);
  const Eigen::Matrix3d W = skew(w);
  return Eigen::Matrix3d::Identity() - 0.5 * W + c * W * W;
}

Eigen::Quaterniond rotation_of_roll_pitch_yaw(const Eigen::Vector3d& roll_pitch_yaw_rad) {
  return Eigen::AngleAxisd(roll_pitch_yaw_rad.z(), Eigen::Vector3d::UnitZ()) *
         Eigen::AngleAxisd(roll_pitch_yaw_rad.y(), Eigen::Vector3d::UnitY()) *
         Eigen::AngleAxisd(roll_pitch_yaw_rad.x(), Eigen::Vector3d::UnitX());
}

Eigen::Vector3d roll_pitch_yaw_of(const Eigen::Quaterniond& rotation) {
  const Eigen::Matrix3d R = rotation.toRotationMatrix();
  const double pitch = std::atan2(-R(2, 0), std::hypot(R(2, 1), R(2, 2)));
  const double roll = std::atan2(R(2, 1), R(2, 2));
  // Of what is left once that roll is taken back: where roll and yaw turn about one axis, roll is anything,
  // and the yaw that goes with it still gives the rotation.
  const double yaw = std::atan2(std::sin(roll) * R(0, 2) - std::cos(roll) * R(0, 1),
                                std::cos(roll) * R(1, 1) - std::sin(roll) * R(1, 2));
  return {roll, pitch, yaw};
}

Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& matrix) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d signs = Eigen::Vector3d::Ones();
  signs(2) = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0 ? -1.0 : 1.0;
  return svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
}

}  // namespace apriltrack
