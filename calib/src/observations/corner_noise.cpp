#include "observations/corner_noise.h"

#include <Eigen/Cholesky>
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

Matrix8d corner_whitening(const CornersPx& corners, const Matrix8d& covariance_px2, const EdgeNoise& noise) {
  const Matrix8d of_model = edge_noise_whitening(corners, noise);
  const double beyond = kBeyondClaim_px / noise.sigma_px;
  const Matrix8d in_model =
      of_model * covariance_px2 * of_model.transpose() + beyond * beyond * Matrix8d::Identity();
  return in_model.llt().matrixL().solve(of_model);
}

Vector8d inward_displacements(const CornersPx& corners) {
  std::array<Eigen::Vector2d, 4> inward_normals;
  for (std::size_t edge = 0; edge < 4; ++edge) {
    const Eigen::Vector2d along = (corners[(edge + 1) % 4] - corners[edge]).normalized();
    inward_normals[edge] = {along.y(), -along.x()};  // a left turn, y down
  }
  Vector8d displacements;
  for (std::size_t corner = 0; corner < 4; ++corner) {
    Eigen::Matrix2d normals;  // of the two edges that meet here: both move by one
    normals << inward_normals[corner].transpose(), inward_normals[(corner + 3) % 4].transpose();
    displacements.segment<2>(2 * static_cast<Eigen::Index>(corner)) =
        normals.inverse() * Eigen::Vector2d::Ones();
  }
  return displacements;
}

}  // namespace apriltrack
