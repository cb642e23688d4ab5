#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <functional>

namespace apriltrack::test {

/// d f / d x at 0 by central differences; f: R^n -> R^m in the tangent at the point of interest.
inline Eigen::MatrixXd numeric_jacobian(const std::function<Eigen::VectorXd(const Eigen::VectorXd&)>& f,
                                        int num_inputs, double step = 1e-6) {
  const Eigen::Index num_outputs = f(Eigen::VectorXd::Zero(num_inputs)).size();
  Eigen::MatrixXd jacobian(num_outputs, num_inputs);
  for (int i = 0; i < num_inputs; ++i) {
    const Eigen::VectorXd delta = step * Eigen::VectorXd::Unit(num_inputs, i);
    jacobian.col(i) = (f(delta) - f(-delta)) / (2.0 * step);
  }
  return jacobian;
}

/// Relative where the entries are large, absolute where they are near zero; prints both matrices on a
/// mismatch.
inline ::testing::AssertionResult jacobians_agree(const Eigen::MatrixXd& analytic,
                                                  const Eigen::MatrixXd& numeric, double tolerance) {
  if (analytic.rows() != numeric.rows() || analytic.cols() != numeric.cols())
    return ::testing::AssertionFailure() << "sizes differ";
  const double scale = std::max(1.0, numeric.cwiseAbs().maxCoeff());
  const double error = (analytic - numeric).cwiseAbs().maxCoeff();
  if (error <= tolerance * scale) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << "largest difference " << error << " of " << scale << "\nanalytic:\n"
                                       << analytic << "\nnumeric:\n"
                                       << numeric;
}

}  // namespace apriltrack::test
