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

/// What a corner errs by beyond what its detector claims for it: the lens model, the paper's flatness, light
/// that changes from view to view. Claims of a few thousandths of a pixel would otherwise count for all
/// others (path-traced recordings: 0.017 to 0.040 px within a tag's views where 0.013 to 0.032 are claimed).
inline constexpr double kBeyondClaim_px = 0.02;

/// W with cov(W * errors) = identity for errors [x0 y0 x1 y1 ...] of that model.
/// corners: convex, in order; sets the directions of the edges.
Matrix8d edge_noise_whitening(const CornersPx& corners, const EdgeNoise& noise);

/// The same where a detector has told the errors' covariance, to which errors of the model's shape and
/// kBeyondClaim_px are added. Rows go with those of the model: sums and differences of edges' ends in turn.
Matrix8d corner_whitening(const CornersPx& corners, const Matrix8d& covariance_px2, const EdgeNoise& noise);

/// How the corners [x0 y0 x1 y1 ...] of a quad move when each of its edges moves inward by one pixel.
/// corners: in the order of a tag seen from its front (bottom-left, bottom-right, top-right, top-left; y
/// down).
Vector8d inward_displacements(const CornersPx& corners);

}  // namespace apriltrack
