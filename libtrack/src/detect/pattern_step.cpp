#include "pattern_step.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cstddef>

#include "tag_quad.h"

namespace apriltrack {

const Matrix8d& corner_moves() {
  static const Matrix8d moves = [] {
    Matrix8d m;
    for (std::size_t k = 0; k < kTagQuad.size(); ++k) {
      const double u = kTagQuad[k].x(), v = kTagQuad[k].y();
      const auto row = 2 * static_cast<Eigen::Index>(k);
      m.row(row) << 1, 0, u, v, 0, 0, u * u, u * v;
      m.row(row + 1) << 0, 1, 0, 0, u, v, u * v, v * v;
    }
    return m;
  }();
  return moves;
}

double largest_corner_move(const Vector8d& step) {
  return (corner_moves() * step).cwiseAbs().maxCoeff();
}

Eigen::Matrix3d moved_plane(const Eigen::Matrix3d& tag_from_straight, const Vector8d& t) {
  Eigen::Matrix3d moved;
  moved << 1.0 + t[2], t[3], t[0], t[4], 1.0 + t[5], t[1], -t[6], -t[7], 1.0;
  return (moved * tag_from_straight).normalized();
}

Eigen::Matrix2d changed_blur(const Eigen::Matrix2d& blur_px2, const Eigen::Vector3d& change_px2,
                             double min_blur_px, double max_blur_px) {
  Eigen::Matrix2d change;
  change << change_px2[0], change_px2[1], change_px2[1], change_px2[2];
  const double size = change.cwiseAbs().maxCoeff(), most = blur_px2.trace();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(
      blur_px2 + std::min(1.0, most / std::max(size, 1e-12)) * change);
  const Eigen::Vector2d variances =
      axes.eigenvalues().cwiseMax(min_blur_px * min_blur_px).cwiseMin(max_blur_px * max_blur_px);
  return axes.eigenvectors() * variances.asDiagonal() * axes.eigenvectors().transpose();
}

}  // namespace apriltrack
