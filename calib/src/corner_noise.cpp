#include "corner_noise.h"

#include <cmath>

namespace apriltrack {

Matrix8d edge_noise_whitening(const CornersPx& corners, const EdgeNoise& noise) {
  // The sum and the difference of an edge's two end errors are independent, with variances 2 (1 +- rho)
  // sigma^2.
  const double sum_weight = 1.0 / (noise.sigma_px * std::sqrt(2.0 * (1.0 + noise.end_correlation)));
  const double difference_weight = 1.0 / (noise.sigma_px * std::sqrt(2.0 * (1.0 - noise.end_correlation)));
  Matrix8d W = Matrix8d::Zero();
  for (int edge = 0; edge < 4; ++edge) {
    const int end = (edge + 1) % 4;
    const Eigen::Vector2d along =
        (corners[static_cast<std::size_t>(end)] - corners[static_cast<std::size_t>(edge)]).normalized();
    const Eigen::RowVector2d normal(-along.y(), along.x());
    W.block<1, 2>(2 * edge, 2 * edge) = sum_weight * normal;
    W.block<1, 2>(2 * edge, 2 * end) = sum_weight * normal;
    W.block<1, 2>(2 * edge + 1, 2 * edge) = difference_weight * normal;
    W.block<1, 2>(2 * edge + 1, 2 * end) = -difference_weight * normal;
  }
  return W;
}

}  // namespace apriltrack
