#pragma once

#include <Eigen/Core>
#include <array>

namespace apriltrack {

using CornersPx = std::array<Eigen::Vector2d, 4>;
using Vector8d = Eigen::Matrix<double, 8, 1>;
using Matrix8d = Eigen::Matrix<double, 8, 8>;

/// How corner errors arise: a detector fits a line to each edge and intersects neighbours. The errors normal
/// to an edge at its two ends have the same sigma and a correlation of their own (-0.5 for a straight-line
/// fit through evenly spaced points; -0.40 to -0.51 measured with AprilTag 3.3); different edges are
/// independent.
struct EdgeNoise {
  double sigma_px = 0.15;
  double end_correlation = -0.45;  ///< In (-1, 1).
};

/// W with cov(W * errors) = identity for errors [x0 y0 x1 y1 ...] of that model.
/// corners: convex, in order; sets the directions of the edges.
Matrix8d edge_noise_whitening(const CornersPx& corners, const EdgeNoise& noise);

/// How the corners [x0 y0 x1 y1 ...] of a quad move when each of its edges moves inward by one pixel.
/// corners: in the order of a tag seen from its front (bottom-left, bottom-right, top-right, top-left; y
/// down).
Vector8d inward_displacements(const CornersPx& corners);

}  // namespace apriltrack
