#include "numerics/se3_manifold.h"

namespace apriltrack {
namespace {

using RowMajor7x6 = Eigen::Matrix<double, 7, 6, Eigen::RowMajor>;

/// The quaternion product q * [v, 0] as a matrix acting on v; coefficients x, y, z, w.
Eigen::Matrix<double, 4, 3> right_product_with_vector(const double* q) {
  Eigen::Matrix<double, 4, 3> m;
  m << q[3], -q[2], q[1],  //
      q[2], q[3], -q[0],   //
      -q[1], q[0], q[3],   //
      -q[0], -q[1], -q[2];
  return m;
}

}  // namespace

PoseBlock to_block(const Pose& pose) {
  const Eigen::Vector4d q = pose.rotation().coeffs();
  const Eigen::Vector3d& t = pose.translation();
  return {q.x(), q.y(), q.z(), q.w(), t.x(), t.y(), t.z()};
}

Pose from_block(const double* block) {
  return {Eigen::Quaterniond(block[3], block[0], block[1], block[2]),
          Eigen::Vector3d(block[4], block[5], block[6])};
}

bool Se3Manifold::Plus(const double* x, const double* delta, double* x_plus_delta) const {
  const PoseBlock moved = to_block(from_block(x) * Pose::exp(Eigen::Map<const Vector6d>(delta)));
  std::copy(moved.begin(), moved.end(), x_plus_delta);
  return true;
}

bool Se3Manifold::PlusJacobian(const double* x, double* jacobian) const {
  Eigen::Map<RowMajor7x6> J(jacobian);
  J.setZero();
  J.topRightCorner<4, 3>() = 0.5 * right_product_with_vector(x);
  J.bottomLeftCorner<3, 3>() = from_block(x).rotation_matrix();
  return true;
}

bool Se3Manifold::Minus(const double* y, const double* x, double* y_minus_x) const {
  Eigen::Map<Vector6d> difference(y_minus_x);
  difference = (from_block(x).inverse() * from_block(y)).log();
  return true;
}

bool Se3Manifold::MinusJacobian(const double* x, double* jacobian) const {
  Eigen::Map<Eigen::Matrix<double, 6, 7, Eigen::RowMajor>> J(jacobian);
  J = tangent_from_ambient(x);
  return true;
}

Eigen::Matrix<double, 6, 7, Eigen::RowMajor> tangent_from_ambient(const double* block) {
  Eigen::Matrix<double, 6, 7, Eigen::RowMajor> J = Eigen::Matrix<double, 6, 7, Eigen::RowMajor>::Zero();
  J.topRightCorner<3, 3>() = from_block(block).rotation_matrix().transpose();
  J.bottomLeftCorner<3, 4>() = 2.0 * right_product_with_vector(block).transpose();
  return J;
}

}  // namespace apriltrack
