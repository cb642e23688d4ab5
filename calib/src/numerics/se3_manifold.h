#pragma once

#include <ceres/manifold.h>

#include <array>

#include "apriltrack/geometry/pose.h"

namespace apriltrack {

/// A pose as Ceres sees it: quaternion x, y, z, w (Eigen's order), then translation.
using PoseBlock = std::array<double, 7>;

PoseBlock to_block(const Pose& pose);
Pose from_block(const double* block);

/// SE(3) with the project's own perturbation: Plus(T, xi) = T * exp(xi), xi = [translation; rotation].
///
/// ceres::EigenQuaternionManifold perturbs on the left and turns by twice its delta; covariances would come
/// out in another frame and at another scale.
class Se3Manifold : public ceres::Manifold {
 public:
  int AmbientSize() const override { return 7; }
  int TangentSize() const override { return 6; }
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override;
  bool PlusJacobian(const double* x, double* jacobian) const override;
  /// y_minus_x = log(x^-1 * y).
  bool Minus(const double* y, const double* x, double* y_minus_x) const override;
  bool MinusJacobian(const double* x, double* jacobian) const override;
};

/// d tangent / d ambient at `block`. A derivative J by the tangent is handed to Ceres as J times this: Ceres
/// multiplies it by the Jacobian of Plus, of which this is a left inverse, and gets J back.
Eigen::Matrix<double, 6, 7, Eigen::RowMajor> tangent_from_ambient(const double* block);

}  // namespace apriltrack
