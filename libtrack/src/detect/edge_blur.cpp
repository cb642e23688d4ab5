#include "apriltrack/detect/edge_blur.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "apriltrack/geometry/homography.h"
#include "apriltrack/tags/tag_family.h"
#include "edge_fit.h"
#include "edge_frame.h"
#include "edge_sampling.h"
#include "tag_quad.h"

namespace apriltrack {
namespace {

/// The first round's guess, and the reach that shows an edge's whole ramp to the second.
constexpr double kFirstSigma_px = 1.2;
constexpr double kFirstReach_px = 4.0;
/// What a lens bends a long edge by (as in corner_refinement.cpp): a bent edge taken for straight looks
/// blurred.
constexpr double kBendOfLens_per_px = 3e-5;
/// What reading light between two pixels blurs by itself: f (1 - f) at the part f of the way, 1/6 on average.
constexpr double kReadingVariance_px2 = 1.0 / 6.0;
constexpr double kWorstResidual = 0.3;  ///< Of the contrast; what leaves more is no edge.

std::optional<FittedEdge> fit_one(const LightSampler& sampler, const TagEdge& edge, const EdgeFrame& frame) {
  EdgeGuess guess{kFirstReach_px, kFirstSigma_px};
  const double length_px = 2.0 * frame.half.norm();
  std::optional<FittedEdge> fitted;
  for (int round = 0; round < 3; ++round) {
    const EdgeSamples near = sample_edge(sampler, edge, frame, guess, guess.sigma_px);
    const EdgeFitOptions options{.initial_sigma_px = guess.sigma_px,
                                 .bend_prior_px = kBendOfLens_per_px * length_px * length_px,
                                 .polarity = edge.is_white_inside ? -1.0 : 1.0};
    fitted = fit_edge(near.samples, near.profiles, options);
    if (!fitted || !(fitted->residual_rms < kWorstResidual)) return std::nullopt;
    guess = {3.0 * fitted->sigma_px + 1.5, fitted->sigma_px};
  }
  return fitted;
}

}  // namespace

std::optional<double> edge_blur_sigma_px(const GrayView& image, const ResponseCurve& response,
                                         const Detection& detection) {
  const auto homography = estimate_homography(kTagQuad, detection.corners_px);
  if (!homography) return std::nullopt;
  const TagFamily& family = TagFamily::get(detection.tag.family);
  const TagPattern pattern = family.pattern(detection.tag.id);
  const LightSampler sampler(image, response);
  std::array<double, kNumCorners> sigmas_px{};
  for (std::size_t k = 0; k < kNumCorners; ++k) {
    const TagEdge edge{pattern, family.has_reversed_border(), *homography, k};
    const auto fitted = fit_one(sampler, edge, edge_frame(detection.corners_px, k));
    if (!fitted) return std::nullopt;
    sigmas_px[k] = fitted->sigma_px;
  }
  const double sigma_px = 0.5 * std::max(sigmas_px[0] + sigmas_px[2], sigmas_px[1] + sigmas_px[3]);
  return std::sqrt(std::max(0.0, sigma_px * sigma_px - kReadingVariance_px2));
}

double motion_of_blur_px(double sigma_px) {
  constexpr double kInFocusVariance_px2 = 0.25 + 1.0 / 12.0;  // the lens, and a pixel's area
  // The normal distribution nearest to an even ramp of length 1 has this sigma (least squares, numerically);
  // the ramp's own standard deviation is 0.289.
  constexpr double kSigmaOfRamp = 0.32;
  return std::sqrt(std::max(0.0, sigma_px * sigma_px - kInFocusVariance_px2)) / kSigmaOfRamp;
}

}  // namespace apriltrack
