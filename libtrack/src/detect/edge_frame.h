#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

#include "apriltrack/tags/tag_corners.h"
#include "edge_fit.h"

namespace apriltrack {

using Quad = std::array<Eigen::Vector2d, kNumCorners>;

/// One edge of the quad as it is assumed now.
struct EdgeFrame {
  Eigen::Vector2d middle;
  Eigen::Vector2d half;    ///< From the middle to the edge's end.
  Eigen::Vector2d normal;  ///< Unit, outwards.

  Eigen::Vector2d point(double along, double across) const { return middle + along * half + across * normal; }
};

/// Edge k of the quad, from corner k to the next.
EdgeFrame edge_frame(const Quad& quad, std::size_t k);

/// Where two fitted, slightly bent edges meet, the end of a and the start of b.
Eigen::Vector2d meet(const EdgeFrame& frame_a, const FittedEdge& edge_a, const EdgeFrame& frame_b,
                     const FittedEdge& edge_b);

/// Between the same corner of both.
double largest_distance(const Quad& a, const Quad& b);

}  // namespace apriltrack
