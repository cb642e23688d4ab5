#include "corner_refinement.h"

#include <algorithm>
#include <cmath>

#include "apriltrack/geometry/homography.h"
#include "edge_fit.h"
#include "edge_sampling.h"
#include "tag_quad.h"

namespace apriltrack {
namespace {

constexpr int kMaxRounds = 4;
constexpr double kConverged_px = 0.2;  // the pattern fit goes on from there
/// What an ordinary lens bends an edge of length L: |k1| x / (4 f) L^2, say k1 = -0.3, x = 0.2, f = 500 px.
/// Small tags so get straight edges, which are twice as sure at their ends, and large ones follow the lens.
constexpr double kLensBend_per_px = 3e-5;
/// Edges whose fit leaves more than this part of the contrast, or whose offset is less sure than this, are no
/// edges.
constexpr double kMaxResidual = 0.3;
constexpr double kMaxSigmaOffset_px = 0.5;

using EdgeGuesses = std::array<EdgeGuess, kNumCorners>;

struct EdgesOfQuad {
  std::array<EdgeFrame, kNumCorners> frames;
  std::array<FittedEdge, kNumCorners> edges;
};

bool is_edge(const FittedEdge& edge, double reach_px) {
  return edge.residual_rms < kMaxResidual && edge.sigma_offset_px < kMaxSigmaOffset_px &&
         std::abs(edge.offset) < reach_px;
}

/// What the first round knows: nothing but how wide cells are.
EdgeGuesses first_guesses(double cell_px) {
  EdgeGuesses guesses;
  guesses.fill({std::max(3.0, 0.5 * cell_px), 1.2});
  return guesses;
}

EdgeGuesses guesses_after(const EdgesOfQuad& fitted) {
  EdgeGuesses guesses;
  for (std::size_t k = 0; k < kNumCorners; ++k) {
    const double sigma_px = fitted.edges[k].sigma_px;
    guesses[k] = {3.0 * sigma_px + 1.5, sigma_px};
  }
  return guesses;
}

/// All four edges near where `quad` has them; nullopt when one cannot be fitted. before: of the last round.
std::optional<EdgesOfQuad> fit_edges(const LightSampler& sampler, const TagPattern& pattern,
                                     bool is_white_inside, double margin_cells, const Quad& quad,
                                     const EdgeGuesses& guesses, const std::optional<EdgesOfQuad>& before) {
  const auto homography = estimate_homography(kTagQuad, quad);
  if (!homography) return std::nullopt;
  EdgesOfQuad fitted;
  for (std::size_t k = 0; k < kNumCorners; ++k) {
    fitted.frames[k] = edge_frame(quad, k);
    const double length_px = 2.0 * fitted.frames[k].half.norm();
    const double sigma_along_px =
        0.5 * (guesses[(k + 1) % kNumCorners].sigma_px + guesses[(k + 3) % kNumCorners].sigma_px);
    const EdgeSamples near = sample_edge(sampler, {pattern, is_white_inside, *homography, k, margin_cells},
                                         fitted.frames[k], guesses[k], sigma_along_px);
    EdgeFitOptions options{.initial_sigma_px = guesses[k].sigma_px,
                           .bend_prior_px = kLensBend_per_px * length_px * length_px,
                           .polarity = is_white_inside ? -1.0 : 1.0};
    if (before) options.before = before->edges[k];
    const auto edge = fit_edge(near.samples, near.profiles, options);
    if (!edge || !is_edge(*edge, guesses[k].reach_px)) return std::nullopt;
    fitted.edges[k] = *edge;
  }
  return fitted;
}

Quad intersections(const EdgesOfQuad& fitted) {
  Quad quad;
  for (std::size_t k = 0; k < kNumCorners; ++k) {
    const std::size_t previous = (k + kNumCorners - 1) % kNumCorners;
    quad[k] = meet(fitted.frames[previous], fitted.edges[previous], fitted.frames[k], fitted.edges[k]);
  }
  return quad;
}

double shortest_edge(const Quad& quad) {
  double length = 1e9;
  for (std::size_t k = 0; k < kNumCorners; ++k)
    length = std::min(length, (quad[(k + 1) % kNumCorners] - quad[k]).norm());
  return length;
}

}  // namespace

std::optional<RefinedCorners> refine_corners(const GrayView& image, const ResponseCurve& response,
                                             const TagPattern& pattern, bool is_white_inside,
                                             const Quad& start_px, double margin_cells) {
  const LightSampler sampler(image, response);
  const double cell_px = shortest_edge(start_px) / pattern.width_at_border();
  const double max_move_px = std::max(3.0, 1.25 * cell_px);
  EdgeGuesses guesses = first_guesses(cell_px);
  std::optional<EdgesOfQuad> fitted;
  Quad quad = start_px;
  for (int round = 0; round < kMaxRounds; ++round) {
    fitted = fit_edges(sampler, pattern, is_white_inside, margin_cells, quad, guesses, fitted);
    if (!fitted) return std::nullopt;
    guesses = guesses_after(*fitted);
    const Quad next = intersections(*fitted);
    if (!(largest_distance(next, start_px) <= max_move_px))
      return std::nullopt;  // not finite counts as too far
    const double move = largest_distance(next, quad);
    quad = next;
    if (move < kConverged_px) break;
  }
  double variance_px2 = 0.0;
  for (const FittedEdge& edge : fitted->edges) variance_px2 += edge.sigma_px * edge.sigma_px / kNumCorners;
  return RefinedCorners{quad, std::sqrt(variance_px2)};
}

}  // namespace apriltrack
