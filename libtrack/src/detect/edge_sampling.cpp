#include "edge_sampling.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace apriltrack {
namespace {

constexpr double kStepAcross_px = 0.75;
constexpr double kStepAlong_px = 1.0;
constexpr int kMaxColumns = 32;
constexpr int kInnerCells = 3;         // cells inside the edge that the profile holds
constexpr int kOuterCells = 2;         // beyond the first outside
constexpr double kMinReach_px = 1.25;  // samples go at least this far from the edge

/// Point of edge k in tag coordinates: `along` in [-1, 1] from corner k to the next, `depth` from the centre
/// (1 is the edge). Edges run along (along, 1), (1, -along), (-along, -1), (-1, along).
Eigen::Vector2d tag_point(std::size_t k, double along, double depth) {
  constexpr double kCos[kNumCorners] = {1.0, 0.0, -1.0, 0.0};
  constexpr double kSin[kNumCorners] = {0.0, 1.0, 0.0, -1.0};
  return {kCos[k] * along + kSin[k] * depth, kCos[k] * depth - kSin[k] * along};
}

/// What of the tag is near one edge, and where.
class EdgeSurroundings {
 public:
  explicit EdgeSurroundings(const TagEdge& edge) : edge_(edge), pattern_(edge.pattern) {}

  /// sigma_along: blur along the edge, in units of `along`.
  EdgeProfile profile(const EdgeFrame& frame, double along, double sigma_along) const {
    EdgeProfile profile;
    double level = level_at(along, sigma_along, -kInnerCells);
    profile.innermost_level = level;
    for (int ring = -kInnerCells + 1; ring <= kOuterCells; ++ring) {
      const double next = level_at(along, sigma_along, ring);
      if (std::abs(next - level) > 0.02) {
        const auto i = static_cast<std::size_t>(profile.num_changes++);
        profile.position_px[i] = ring == 0 ? 0.0 : across_px(frame, along, 1.0 + ring * pattern_.cell_size());
        profile.height[i] = next - level;
        level = next;
      }
    }
    return profile;
  }

  /// Pixels across the frame's edge of a point at `depth` from the tag's centre.
  double across_px(const EdgeFrame& frame, double along, double depth) const {
    const Eigen::Vector3d tag = tag_point(edge_.index, along, depth).homogeneous();
    return frame.normal.dot((edge_.homography * tag).hnormalized() - frame.middle);
  }

 private:
  /// Level of the cell in ring `ring`, 0 the first outside the edge, -1 the border; smeared along the edge.
  double level_at(double along, double sigma_along, int ring) const {
    if (ring == 0) return 1.0;
    if (ring == -1) return 0.0;
    const double depth = 1.0 + (ring + 0.5) * pattern_.cell_size();
    double sum = 0.0;
    for (const double z : {-1.3, -0.5, 0.0, 0.5, 1.3}) {  // near enough to a normal distribution's spread
      const Eigen::Vector2d point = tag_point(edge_.index, along + z * sigma_along, depth);
      sum += pattern_.brightness(point.x(), point.y());
    }
    const double brightness = sum / 5.0;
    return edge_.is_white_inside ? 1.0 - brightness : brightness;
  }

  const TagEdge& edge_;
  const TagPattern& pattern_;
};

}  // namespace

EdgeSamples sample_edge(const LightSampler& sampler, const TagEdge& edge, const EdgeFrame& frame,
                        const EdgeGuess& guess, double sigma_along_px) {
  const EdgeSurroundings surroundings(edge);
  const double cell = edge.pattern.cell_size();
  const double printed = std::min(edge.pattern.half_extent(), 1.0 + edge.margin_cells * cell);
  const double half_length_px = frame.half.norm();
  // Corners are rounded by blur, and Kalibr's black squares touch them.
  const double skip = std::min(0.4, std::max(0.5 * cell, 1.5 / half_length_px));
  const int columns =
      std::clamp(static_cast<int>(2.0 * (1.0 - skip) * half_length_px / kStepAlong_px), 6, kMaxColumns);
  EdgeSamples out;
  for (int i = 0; i < columns; ++i) {
    const double along = (1.0 - skip) * (2.0 * (i + 0.5) / columns - 1.0);
    out.profiles.push_back(surroundings.profile(frame, along, sigma_along_px / half_length_px));
    const double inner = std::max(surroundings.across_px(frame, along, 1.0 - 2.5 * cell), -guess.reach_px);
    const double outer = surroundings.across_px(frame, along, printed);
    const double limit = std::min(std::max(outer - 0.5, kMinReach_px), guess.reach_px);
    for (double across = -std::floor(-inner / kStepAcross_px) * kStepAcross_px; across <= limit;
         across += kStepAcross_px) {
      const std::optional<double> light = sampler.at(frame.point(along, across));
      if (light) out.samples.push_back({along, across, *light, out.profiles.size() - 1});
    }
  }
  return out;
}

}  // namespace apriltrack
