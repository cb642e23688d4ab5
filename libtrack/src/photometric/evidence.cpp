#include "apriltrack/photometric/evidence.h"

#include <algorithm>
#include <utility>

#include "active_tags.h"
#include "apriltrack/photometric/profile_likelihood.h"

namespace apriltrack {
namespace {

constexpr double kMaxSamples = 340.0;  // of one tag: a patch of 32 x 32, three samples counted as one

}  // namespace

double TagEvidence::independent_samples() const {
  return std::min({kMaxSamples, area_px / kPixelsPerIndependentSample, static_cast<double>(num_pixels)});
}

std::vector<TagEvidence> explained_tags(const std::vector<TagEvidence>& tags) {
  std::vector<TagEvidence> explained;
  std::ranges::copy_if(tags, std::back_inserter(explained), &TagEvidence::is_explained);
  return explained.empty() ? tags : explained;
}

std::vector<TagEvidence> weigh_evidence(PhotometricWorld& world, const PhotometricFrame& frame,
                                        const MotionState& state, const EvidenceOptions& options) {
  std::vector<TagEvidence> evidence;
  for (const ActiveTag& active : active_tags(world, frame, state, options.level, options.max_pixels_per_tag,
                                             options.extra_sigma_px, options.with_hidden)) {
    TagMisfit misfit = measure_misfit(active.pixels, active.predicted, 0.0);
    if (options.is_robust) misfit = measure_misfit(active.pixels, active.predicted, scale_of(misfit));
    evidence.push_back({active.index, static_cast<int>(active.pixels.count), active.pixels.area_px,
                        misfit.correlation, misfit.colours.gain, active.path_px});
  }
  return evidence;
}

double log_likelihood(const std::vector<TagEvidence>& tags) {
  double sum = 0.0;
  for (const TagEvidence& tag : tags)
    sum += profile_log_likelihood(tag.correlation, tag.independent_samples(), kUnexplainedVariance);
  return sum;
}

double mean_correlation(const std::vector<TagEvidence>& tags) {
  double sum = 0.0, weight = 0.0;
  for (const TagEvidence& tag : tags) {
    sum += tag.independent_samples() * tag.correlation;
    weight += tag.independent_samples();
  }
  return weight > 0.0 ? sum / weight : 0.0;
}

double typical_correlation(const std::vector<TagEvidence>& tags) {
  std::vector<std::pair<double, double>> weighed;  // correlation, samples
  double total = 0.0;
  for (const TagEvidence& tag : tags) {
    weighed.emplace_back(tag.correlation, tag.independent_samples());
    total += tag.independent_samples();
  }
  std::sort(weighed.rbegin(), weighed.rend());
  double reached = 0.0;
  for (const auto& [correlation, samples] : weighed) {
    reached += samples;
    if (reached >= 0.5 * total) return correlation;
  }
  return 0.0;
}

}  // namespace apriltrack
