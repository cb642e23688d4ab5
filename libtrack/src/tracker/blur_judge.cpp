#include "blur_judge.h"

#include <algorithm>

namespace apriltrack {
namespace {

constexpr double kMinCorrelationWithDetection = 0.5;
// Found again without a detection: a wide search also finds what merely looks like a blurred tag. It reached
// 0.95, and 11 standard deviations of the motion, before a wall of patches; right states reached 7.5 of them.
constexpr double kMinCorrelationAgain = 0.95;
constexpr double kMaxSigmas = 9.0;
// After a longer time without evidence the motion's prior is too wide to hold a claim: it is found again.
constexpr double kMaxFollowed_s = 0.1;
// Of what a claim without a detection rests on: a sliver of a border fits nearly any edge.
constexpr double kMinSamples = 40.0;

int num_explained(const std::vector<TagEvidence>& tags) {
  return static_cast<int>(std::ranges::count_if(tags, &TagEvidence::is_explained));
}

double samples_of_explained(const std::vector<TagEvidence>& tags) {
  double sum = 0.0;
  for (const TagEvidence& tag : tags) sum += tag.is_explained() ? tag.independent_samples() : 0.0;
  return sum;
}

}  // namespace

bool BlurJudge::is_convincing(const Explanation& explanation, const std::optional<double>& interval_s) const {
  const TagVotes& votes = explanation.votes;
  if (num_supporting(explanation) <= votes.contradicting) return false;
  const std::vector<TagEvidence> tags = quorum(trusted_tags(explanation), votes);
  const double correlation = typical_correlation(tags);
  if (!votes.agreeing.empty()) return correlation >= kMinCorrelationWithDetection;
  const bool is_followed = is_confirmed_ && interval_s && *interval_s <= kMaxFollowed_s;
  return samples_of_explained(tags) >= kMinSamples &&
         correlation >= (is_followed ? TagEvidence::kExplained : kMinCorrelationAgain) &&
         explanation.prior_cost <= 0.5 * kMaxSigmas * kMaxSigmas;
}

int BlurJudge::num_supporting(const Explanation& explanation) const {
  return std::max(num_explained(trusted_tags(explanation)),
                  static_cast<int>(explanation.votes.agreeing.size()));
}

void BlurJudge::claimed(const Explanation& explanation) {
  contrasts_.remember(trusted_tags(explanation));
  is_confirmed_ = is_confirmed_ || !explanation.votes.agreeing.empty();
}

std::vector<TagEvidence> BlurJudge::trusted_tags(const Explanation& explanation) const {
  std::vector<TagEvidence> tags = explanation.fit.tags;
  if (explanation.votes.agreeing.empty()) contrasts_.doubt(tags);
  return tags;
}

}  // namespace apriltrack
