#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "joint_workspace.h"

namespace apriltrack {

/// Whether scores of a quarter of the samples bound those of all, and anything is to be gained by it.
bool JointLikelihood::has_bounds() const {
  return options_.error == PatchError::kGaussianProfile && std::isfinite(options_.negligible_log_ratio);
}

/// Those that are not known to be so much less likely than one of that log-likelihood.
void JointLikelihood::select_possible(double log_likelihood) {
  const double least = log_likelihood - options_.negligible_log_ratio;
  work_->selection.resize(work_->bounds.size());
  std::iota(work_->selection.begin(), work_->selection.end(), std::size_t{0});
  std::erase_if(work_->selection, [&](std::size_t hypothesis) { return work_->bounds[hypothesis] < least; });
}

/// Of what the scores of some samples say, those that may yet be the best.
void JointLikelihood::select_promising(const JointScores& scores) {
  struct Coarse {
    double mean = 0.0, variance = 0.0;
  };
  const auto coarse_of = [&](std::size_t hypothesis) {
    Coarse coarse;
    for (std::size_t k = 0; k < num_tags(); ++k) {
      const TagScore& tag = scores.tag(hypothesis, k);
      if (!(tag.seen_share > 0.0)) continue;
      const double c = tag.correlation;
      coarse.mean += std::min(c, c * tag.seen_share);  // (12)
      const double num_seen = tag.seen_share * static_cast<double>(work_->of(SampleSet::kSome).cells.size());
      coarse.variance += tag.seen_share * tag.seen_share * (1.0 - c * c) * (1.0 - c * c) / num_seen;
    }
    return coarse;
  };
  Coarse best{.mean = -std::numeric_limits<double>::infinity()};
  for (const std::size_t hypothesis : work_->selection) {
    const Coarse coarse = coarse_of(hypothesis);
    if (coarse.mean > best.mean) best = coarse;
  }
  std::erase_if(work_->selection, [&](std::size_t hypothesis) {
    const Coarse coarse = coarse_of(hypothesis);
    return coarse.mean + options_.coarse_sigmas * std::sqrt(coarse.variance + best.variance) < best.mean;
  });
}

}  // namespace apriltrack
