#include "apriltrack/photometric/evidence.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "apriltrack/photometric/profile_likelihood.h"
#include "photometric_scratch.h"

namespace apriltrack {
namespace {

/// What `share` of the independent samples reach.
double correlation_of_share(const std::vector<TagEvidence>& tags, double share) {
  std::vector<std::pair<double, double>> weighed;  // correlation, samples
  double total = 0.0;
  for (const TagEvidence& tag : tags) {
    weighed.emplace_back(tag.clean_correlation(), tag.independent_samples());
    total += tag.independent_samples();
  }
  std::sort(weighed.rbegin(), weighed.rend());
  double reached = 0.0;
  for (const auto& [correlation, samples] : weighed) {
    reached += samples;
    if (reached >= share * total) return correlation;
  }
  return 0.0;
}

constexpr double kMaxSamples = 340.0;  // of one tag: a patch of 32 x 32, three samples counted as one

}  // namespace

double TagEvidence::independent_samples() const {
  return std::min({kMaxSamples, area_px / kPixelsPerIndependentSample, static_cast<double>(num_pixels)});
}

double TagEvidence::clean_correlation() const {
  // A share of the noise counts as left over: its size is itself a guess.
  constexpr double kDoubtOfNoise = 0.1;
  const double left =
      std::max(0.0, 1.0 - correlation * correlation - noise_share) + kDoubtOfNoise * noise_share;
  const double total = 1.0 - (1.0 - kDoubtOfNoise) * noise_share;
  return std::sqrt(std::max(0.0, 1.0 - left / total));
}

std::vector<TagEvidence> explained_tags(const std::vector<TagEvidence>& tags) {
  std::vector<TagEvidence> explained;
  std::ranges::copy_if(tags, std::back_inserter(explained), &TagEvidence::is_explained);
  return explained.empty() ? tags : explained;
}

std::vector<TagEvidence> weigh_evidence(PhotometricWorld& world, const PhotometricFrame& frame,
                                        const MotionState& state, const EvidenceOptions& options) {
  std::vector<float>& weights = world.scratch->weights;
  std::vector<TagEvidence> evidence;
  for (const ActiveTag& tag : find_active_tags(world, frame, state, options)) {
    const auto misfit_at = [&](double scale) {
      return measure_misfit(tag.pixels, tag.predicted, scale, &weights);
    };
    TagMisfit misfit = misfit_at(0.0);
    if (options.is_robust) misfit = misfit_at(scale_of(misfit));
    evidence.push_back(evidence_of(tag, misfit));
  }
  return evidence;
}

double identity_log_odds(PhotometricWorld& world, const PhotometricFrame& frame, const MotionState& state,
                         const std::vector<TagEvidence>& tags) {
  const auto wear = [&](std::size_t first_pattern) {
    for (const TagEvidence& one : tags) {
      const auto own = static_cast<std::size_t>(one.tag_index);
      world.tags[own].index = first_pattern + own;
    }
  };
  wear(world.tags.size());  // the mean of each one's family
  std::vector<TagEvidence> as_any = weigh_evidence(world, frame, state);
  wear(0);
  std::erase_if(as_any, [&](const TagEvidence& one) {
    return std::ranges::count(tags, one.tag_index, &TagEvidence::tag_index) == 0;
  });
  return log_likelihood(tags) - log_likelihood(as_any);
}

double log_likelihood(const std::vector<TagEvidence>& tags) {
  double sum = 0.0;
  for (const TagEvidence& tag : tags) sum += tag.log_likelihood();
  return sum;
}

double TagEvidence::log_likelihood() const {
  return profile_log_likelihood(correlation, independent_samples(), kUnexplainedVariance);
}

double typical_correlation(const std::vector<TagEvidence>& tags) {
  return correlation_of_share(tags, 0.5);
}

double widespread_correlation(const std::vector<TagEvidence>& tags) {
  return correlation_of_share(tags, 2.0 / 3.0);
}

}  // namespace apriltrack
