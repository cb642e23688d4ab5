#pragma once

#include <cmath>

namespace apriltrack {

/// Cauchy's loss: half a sum of squares while that is small against the scale's, then growing like its
/// logarithm, so that what is far off counts little.
struct CauchyLoss {
  double scale = 1.0;  ///< In units of the residual's norm.

  double cost(double squares) const { return 0.5 * scale * scale * std::log1p(squares / (scale * scale)); }
  /// What the squares count in the normal equations: the derivative of the cost by half of them.
  double weight(double squares) const { return 1.0 / (1.0 + squares / (scale * scale)); }
};

}  // namespace apriltrack
