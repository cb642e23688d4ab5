#include "edge_frame.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>

namespace apriltrack {

EdgeFrame edge_frame(const Quad& quad, std::size_t k) {
  const Eigen::Vector2d& begin = quad[k];
  const Eigen::Vector2d& end = quad[(k + 1) % kNumCorners];
  EdgeFrame frame;
  frame.middle = 0.5 * (begin + end);
  frame.half = 0.5 * (end - begin);
  frame.normal = Eigen::Vector2d(-frame.half.y(), frame.half.x()).normalized();
  const Eigen::Vector2d centre = 0.25 * (quad[0] + quad[1] + quad[2] + quad[3]);
  if (frame.normal.dot(frame.middle - centre) < 0.0) frame.normal = -frame.normal;
  return frame;
}

Eigen::Vector2d meet(const EdgeFrame& frame_a, const FittedEdge& edge_a, const EdgeFrame& frame_b,
                     const FittedEdge& edge_b) {
  // A few steps of the secant between their end points.
  double a = 1.0;   // the end of a
  double b = -1.0;  // the start of b
  Eigen::Vector2d point = Eigen::Vector2d::Zero();
  for (int i = 0; i < 5; ++i) {
    const Eigen::Vector2d point_a = frame_a.point(a, edge_a.offset_px(a));
    const Eigen::Vector2d point_b = frame_b.point(b, edge_b.offset_px(b));
    Eigen::Matrix2d directions;
    directions.col(0) = frame_a.half + (edge_a.slope + 2.0 * edge_a.bend * a) * frame_a.normal;
    directions.col(1) = -(frame_b.half + (edge_b.slope + 2.0 * edge_b.bend * b) * frame_b.normal);
    const Eigen::Vector2d step = directions.partialPivLu().solve(point_b - point_a);
    point = point_a + step.x() * directions.col(0);
    a += step.x();
    b += step.y();
  }
  return point;
}

double largest_distance(const Quad& a, const Quad& b) {
  double distance = 0.0;
  for (std::size_t k = 0; k < kNumCorners; ++k) distance = std::max(distance, (a[k] - b[k]).norm());
  return distance;
}

}  // namespace apriltrack
