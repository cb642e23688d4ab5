#include <algorithm>
#include <cmath>

#include "joint_workspace.h"

namespace apriltrack {
namespace {

/// Samples whose template is held at once: rays, light and presence stay in the innermost cache.
constexpr std::size_t kMaxPredicted = 8 * kPatchBlock;
/// Samples that are summed in single precision.
constexpr std::size_t kMaxSummed = 64 * kPatchBlock;

/// docs/algorithms/paper_filter.md, equations (13) to (15).
double log_likelihood(const JointLikelihoodOptions& options, const TagScore& score, double independent) {
  // What is not seen counts as uncorrelated; what speaks against the hypothesis is not made less of.
  const double c = std::min(score.correlation, score.correlation * score.seen_share);  // (12)
  switch (options.error) {
    case PatchError::kLinear:
      return -options.gamma * (0.5 - 0.5 * c);
    case PatchError::kMinusLog:
      return options.gamma * std::log(std::max(c, options.min_correlation));
    case PatchError::kGaussianProfile:
      break;
  }
  const double positive = std::max(score.correlation, 0.0);
  const double num_samples = independent * score.seen_share;
  return profile_log_likelihood(positive, num_samples, options.kappa) -
         profile_log_likelihood(0.0, num_samples, options.kappa);
}

/// A patch against a reference.
PatchSums sums_of(const PairedRows& image, const LensFactors& lens, const PatchPlacement& placement,
                  const PatchColumns& columns) {
  PatchSums sums;
  for (std::size_t first = 0; first < columns.size(); first += kMaxSummed) {
    const std::size_t count = std::min(kMaxSummed, columns.size() - first);
    // Of all the template: where it is read at all, every part of it is seen.
    const bool is_first = first == 0;
    const TemplateColumns expected = {columns.light.data() + first, nullptr, 0.0,
                                      is_first ? columns.sum_squares : 0.0};
    sums.add(sum_patch(image, lens, placement, columns.samples(first, count), expected));
  }
  return sums;
}

/// A patch against the tag's pattern along the hypothesis' path.
PatchSums sums_of(const PairedRows& image, const LensFactors& lens, const PatchPlacement& placement,
                  const PatchColumns& columns, const TagPrediction& prediction,
                  const std::array<float, 9>& camera_from_plane) {
  std::array<float, kMaxPredicted> ray_x, ray_y, light, presence;
  PatchSums sums;
  for (std::size_t first = 0; first < columns.size(); first += kMaxPredicted) {
    const std::size_t count = std::min(kMaxPredicted, columns.size() - first);
    const SampleColumns samples = columns.samples(first, count);
    cast_patch(camera_from_plane, samples, ray_x.data(), ray_y.data());
    predict_pixels(prediction.texel_path(), {ray_x.data(), ray_y.data(), count}, light.data(),
                   presence.data());
    sums.add(sum_patch(image, lens, placement, samples, {light.data(), presence.data()}));
  }
  return sums;
}

/// Squares of the template's light about its mean, among the samples seen.
double template_squares(const PatchSums& sums) {
  return sums.count > 0.0 ? std::max(sums.bb - sums.b * sums.b / sums.count, 0.0) : 0.0;
}

}  // namespace

void JointLikelihood::score_hypothesis(const Batch& batch, std::size_t position, JointScores* scores) const {
  const std::size_t hypothesis = batch.selection[position];
  double sum = 0.0, bound = 0.0;
  int num_used = 0;
  for (std::size_t k = 0; k < num_tags(); ++k) {
    TagScore& score = scores->tags[hypothesis * num_tags() + k];
    score = {};
    if (!takes_part(k)) continue;
    score = score_tag(batch, position, k, &bound);
    sum += score.log_likelihood;
    ++num_used;
  }
  const double divisor = options_.average_over_tags && num_used > 0 ? num_used : 1.0;
  scores->log_likelihoods[hypothesis] = sum / divisor;  // (16), (17)
  if (batch.set == SampleSet::kQuarter) work_->bounds[hypothesis] = bound / divisor;
}

/// Adds to `bound` what the tag's log-likelihood is at most.
TagScore JointLikelihood::score_tag(const Batch& batch, std::size_t position, std::size_t index,
                                    double* bound) const {
  TagScore score;
  const PatchInView& view = work_->views[position * num_tags() + index];
  if (!view.is_in_view) {
    score.log_likelihood = log_likelihood(options_, score, 0.0);
    return score;
  }
  const PatchSamples& samples = work_->of(batch.set);
  const PatchPlacement& placement = view.placed.placement;
  const PatchSums sums = world_ ? sums_of(batch.image, work_->lens, placement, samples.grid,
                                          work_->predictions[view.prediction], view.camera_from_plane)
                                : sums_of(batch.image, work_->lens, placement, samples.references[index]);
  const PatchMatch match = match_of(sums);
  score.correlation = match.correlation;
  // Too few to tell anything are none.
  if (match.num_samples >= PatchMatch::kMinSamples)
    score.seen_share = static_cast<double>(match.num_samples) / static_cast<double>(samples.cells.size());
  score.log_likelihood = log_likelihood(options_, score, view.num_independent);
  if (batch.set == SampleSet::kQuarter) {
    const double share = template_squares(sums) / max_template_squares(index);
    *bound +=
        log_likelihood(options_, {0.0, max_correlation(match.correlation, share), 1.0}, view.num_independent);
  }
  return score;
}

/// Of all samples, in the units of the quarter's.
double JointLikelihood::max_template_squares(std::size_t index) const {
  // The mean of the squares of numbers in [0, 1] about their mean is a quarter at most.
  if (world_) return 0.25 * static_cast<double>(work_->of(SampleSet::kAll).cells.size());
  const PatchColumns& all = work_->of(SampleSet::kAll).references[index];
  const PatchColumns& quarter = work_->of(SampleSet::kQuarter).references[index];
  return quarter.sum_squares * all.reference_squares / quarter.reference_squares;
}

}  // namespace apriltrack
