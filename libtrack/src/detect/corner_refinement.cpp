#include "corner_refinement.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "edge_fit.h"

namespace apriltrack {
namespace {

constexpr int kMaxRounds = 4;
constexpr double kConverged_px = 0.02;
constexpr double kStepAcross_px = 0.75;
constexpr double kStepAlong_px = 1.0;
constexpr int kMaxColumns = 32;
constexpr int kInnerCells = 3;         // cells inside the edge that the profile holds
constexpr int kOuterCells = 2;         // beyond the first outside
constexpr double kMinReach_px = 1.25;  // samples go at least this far from the edge
/// What an ordinary lens bends an edge of length L: |k1| x / (4 f) L^2, say k1 = -0.3, x = 0.2, f = 500 px.
/// Small tags so get straight edges, which are twice as sure at their ends, and large ones follow the lens.
constexpr double kLensBend_per_px = 3e-5;
/// Edges whose fit leaves more than this part of the contrast, or whose offset is less sure than this, are no
/// edges.
constexpr double kMaxResidual = 0.3;
constexpr double kMaxSigmaOffset_px = 0.5;

class LightSampler {
 public:
  LightSampler(const GrayView& image, const ResponseCurve& response)
      : image_(image), light_(response.linear_light()) {}

  /// Between the four pixels around; nullopt outside the image.
  std::optional<double> at(const Eigen::Vector2d& point) const {
    const double x = std::floor(point.x());
    const double y = std::floor(point.y());
    if (!(x >= 0.0 && y >= 0.0 && x + 1.0 < image_.width() && y + 1.0 < image_.height())) return std::nullopt;
    const std::uint8_t* upper = image_.row(static_cast<int>(y)) + static_cast<int>(x);
    const std::uint8_t* lower = upper + image_.stride();
    const double fx = point.x() - x;
    const double fy = point.y() - y;
    const double top = light_[upper[0]] + fx * (light_[upper[1]] - light_[upper[0]]);
    const double bottom = light_[lower[0]] + fx * (light_[lower[1]] - light_[lower[0]]);
    return top + fy * (bottom - top);
  }

 private:
  GrayView image_;
  const std::array<float, 256>& light_;
};

/// Projective map from tag coordinates, [-1, 1] at the corners, to pixels.
std::optional<Eigen::Matrix3d> homography_of(const Quad& quad) {
  constexpr double kU[kNumCorners] = {-1.0, 1.0, 1.0, -1.0};
  constexpr double kV[kNumCorners] = {1.0, 1.0, -1.0, -1.0};
  Eigen::Matrix<double, 8, 8> a;
  Eigen::Matrix<double, 8, 1> b;
  for (int k = 0; k < kNumCorners; ++k) {
    const Eigen::Vector2d& p = quad[static_cast<std::size_t>(k)];
    a.row(2 * k) << kU[k], kV[k], 1.0, 0.0, 0.0, 0.0, -p.x() * kU[k], -p.x() * kV[k];
    a.row(2 * k + 1) << 0.0, 0.0, 0.0, kU[k], kV[k], 1.0, -p.y() * kU[k], -p.y() * kV[k];
    b.segment<2>(2 * k) = p;
  }
  const Eigen::Matrix<double, 8, 1> h = a.partialPivLu().solve(b);
  if (!h.allFinite()) return std::nullopt;
  Eigen::Matrix3d homography;
  homography << h[0], h[1], h[2], h[3], h[4], h[5], h[6], h[7], 1.0;
  return homography;
}

/// One edge of the quad as it is assumed now.
struct EdgeFrame {
  Eigen::Vector2d middle;
  Eigen::Vector2d half;    ///< From the middle to the edge's end.
  Eigen::Vector2d normal;  ///< Unit, outwards.

  Eigen::Vector2d point(double along, double across) const { return middle + along * half + across * normal; }
};

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

/// Point of edge k in tag coordinates: `along` in [-1, 1] from corner k to the next, `depth` from the centre
/// (1 is the edge). Edges run along (along, 1), (1, -along), (-along, -1), (-1, along).
Eigen::Vector2d tag_point(std::size_t k, double along, double depth) {
  constexpr double kCos[kNumCorners] = {1.0, 0.0, -1.0, 0.0};
  constexpr double kSin[kNumCorners] = {0.0, 1.0, 0.0, -1.0};
  return {kCos[k] * along + kSin[k] * depth, kCos[k] * depth - kSin[k] * along};
}

struct EdgeGuess {
  double reach_px = 0.0;  ///< How far to look on either side.
  double sigma_px = 0.0;
};

/// What of the tag is near one edge, and where.
class EdgeSurroundings {
 public:
  EdgeSurroundings(const TagPattern& pattern, bool is_white_inside, const Eigen::Matrix3d& homography,
                   std::size_t k)
      : pattern_(pattern), is_white_inside_(is_white_inside), homography_(homography), k_(k) {}

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
    const Eigen::Vector3d tag = tag_point(k_, along, depth).homogeneous();
    return frame.normal.dot((homography_ * tag).hnormalized() - frame.middle);
  }

 private:
  /// Level of the cell in ring `ring`, 0 the first outside the edge, -1 the border; smeared along the edge.
  double level_at(double along, double sigma_along, int ring) const {
    if (ring == 0) return 1.0;
    if (ring == -1) return 0.0;
    const double depth = 1.0 + (ring + 0.5) * pattern_.cell_size();
    double sum = 0.0;
    for (const double z : {-1.3, -0.5, 0.0, 0.5, 1.3}) {  // near enough to a normal distribution's spread
      const Eigen::Vector2d point = tag_point(k_, along + z * sigma_along, depth);
      sum += pattern_.brightness(point.x(), point.y());
    }
    const double brightness = sum / 5.0;
    return is_white_inside_ ? 1.0 - brightness : brightness;
  }

  const TagPattern& pattern_;
  bool is_white_inside_;
  const Eigen::Matrix3d& homography_;
  std::size_t k_;
};

struct EdgeSamples {
  std::vector<EdgeSample> samples;
  std::vector<EdgeProfile> profiles;
};

EdgeSamples sample_edge(const LightSampler& sampler, const EdgeSurroundings& surroundings,
                        const TagPattern& pattern, const EdgeFrame& frame, const EdgeGuess& guess,
                        double sigma_along_px) {
  const double cell = pattern.cell_size();
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
    const double outer = surroundings.across_px(frame, along, pattern.half_extent());
    const double limit = std::min(std::max(outer - 0.5, kMinReach_px), guess.reach_px);
    for (double across = -std::floor(-inner / kStepAcross_px) * kStepAcross_px; across <= limit;
         across += kStepAcross_px) {
      const std::optional<double> light = sampler.at(frame.point(along, across));
      if (light) out.samples.push_back({along, across, *light, out.profiles.size() - 1});
    }
  }
  return out;
}

/// Where two fitted, slightly bent edges meet: a few steps of the secant between their end points.
Eigen::Vector2d meet(const EdgeFrame& frame_a, const FittedEdge& edge_a, const EdgeFrame& frame_b,
                     const FittedEdge& edge_b) {
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

bool is_edge(const FittedEdge& edge, double reach_px) {
  return edge.residual_rms < kMaxResidual && edge.sigma_offset_px < kMaxSigmaOffset_px &&
         std::abs(edge.offset) < reach_px;
}

double largest_move(const Quad& a, const Quad& b) {
  double move = 0.0;
  for (std::size_t k = 0; k < kNumCorners; ++k) move = std::max(move, (a[k] - b[k]).norm());
  return move;
}

double shortest_edge(const Quad& quad) {
  double length = 1e9;
  for (std::size_t k = 0; k < kNumCorners; ++k)
    length = std::min(length, (quad[(k + 1) % kNumCorners] - quad[k]).norm());
  return length;
}

}  // namespace

std::optional<Quad> refine_corners(const GrayView& image, const ResponseCurve& response,
                                   const TagPattern& pattern, bool is_white_inside, const Quad& start_px) {
  const LightSampler sampler(image, response);
  const double cell_px = shortest_edge(start_px) / pattern.width_at_border();
  const double max_move_px = std::max(3.0, 1.25 * cell_px);
  std::array<EdgeGuess, kNumCorners> guesses;
  guesses.fill({std::max(3.0, 0.5 * cell_px), 1.2});
  Quad quad = start_px;
  for (int round = 0; round < kMaxRounds; ++round) {
    const std::optional<Eigen::Matrix3d> homography = homography_of(quad);
    if (!homography) return std::nullopt;
    std::array<EdgeFrame, kNumCorners> frames;
    std::array<FittedEdge, kNumCorners> edges;
    for (std::size_t k = 0; k < kNumCorners; ++k) {
      frames[k] = edge_frame(quad, k);
      const double length_px = 2.0 * frames[k].half.norm();
      const double sigma_along_px =
          0.5 * (guesses[(k + 1) % kNumCorners].sigma_px + guesses[(k + 3) % kNumCorners].sigma_px);
      const EdgeSurroundings surroundings(pattern, is_white_inside, *homography, k);
      const EdgeSamples near =
          sample_edge(sampler, surroundings, pattern, frames[k], guesses[k], sigma_along_px);
      const std::optional<FittedEdge> edge =
          fit_edge(near.samples, near.profiles,
                   {.initial_sigma_px = guesses[k].sigma_px,
                    .bend_prior_px = kLensBend_per_px * length_px * length_px,
                    .polarity = is_white_inside ? -1.0 : 1.0});
      if (!edge || !is_edge(*edge, guesses[k].reach_px)) return std::nullopt;
      edges[k] = *edge;
    }
    for (std::size_t k = 0; k < kNumCorners; ++k)
      guesses[k] = {3.0 * edges[k].sigma_px + 1.5, edges[k].sigma_px};
    Quad next;
    for (std::size_t k = 0; k < kNumCorners; ++k) {
      const std::size_t previous = (k + kNumCorners - 1) % kNumCorners;
      next[k] = meet(frames[previous], edges[previous], frames[k], edges[k]);
    }
    if (!(largest_move(next, start_px) <= max_move_px)) return std::nullopt;  // not finite counts as too far
    const double move = largest_move(next, quad);
    quad = next;
    if (move < kConverged_px) break;
  }
  return quad;
}

}  // namespace apriltrack
