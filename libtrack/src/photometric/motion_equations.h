#pragma once

#include <Eigen/Cholesky>

#include "apriltrack/motion/motion_state.h"

namespace apriltrack {

/// Gauss and Newton's equations H dx = -g of a cost: by a state, or by a left perturbation of the camera's
/// view of the map and by its rate.
struct MotionEquations {
  Matrix12d H = Matrix12d::Zero();
  Vector12d g = Vector12d::Zero();

  MotionEquations& operator+=(const MotionEquations& other) {
    H += other.H;
    g += other.g;
    return *this;
  }

  /// The step that they ask for.
  Vector12d step() const { return -H.ldlt().solve(g); }
  /// Squared standard deviations that their own step would move the state by, which is twice what it should
  /// lower the cost by; less of a shorter one.
  double worth(const Vector12d& step) const { return -g.dot(step); }
};

}  // namespace apriltrack
