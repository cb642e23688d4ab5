#include "blur_judge.h"

#include <algorithm>

namespace apriltrack {
namespace {

// Right states reach 0.943 and more where a tag is read, 0.957 where none is, in photoreal recordings; half a
// tag behind a hand costs some of that.
constexpr double kMinCorrelation = 0.85;
constexpr double kMinCorrelationWithDetection = 0.5;
// Found again without a detection: a wide search also finds what merely looks like a blurred tag. It reached
// 0.95, and 11 standard deviations of the motion, before a wall of patches; right states reached 7.5 of them.
constexpr double kMinCorrelationAgain = 0.95;
constexpr double kMaxSigmas = 9.0;
// Of what a claim without a detection rests on: a sliver of a border fits nearly any edge.
constexpr double kMinSamples = 40.0;

bool is_explained(const TagEvidence& tag) {
  return tag.correlation >= kMinCorrelation;
}

int num_explained(const std::vector<TagEvidence>& tags) {
  return static_cast<int>(std::ranges::count_if(tags, is_explained));
}

double samples_of_explained(const std::vector<TagEvidence>& tags) {
  double sum = 0.0;
  for (const TagEvidence& tag : tags) sum += is_explained(tag) ? tag.independent_samples() : 0.0;
  return sum;
}

}  // namespace

bool BlurJudge::is_convincing(const Explanation& explanation, const TagVotes& votes) const {
  if (num_supporting(explanation, votes) <= votes.contradicting) return false;
  const std::vector<TagEvidence> tags = trusted_tags(explanation, votes);
  const double correlation = typical_correlation(tags);
  if (votes.agreeing > 0) return correlation >= kMinCorrelationWithDetection;
  return samples_of_explained(tags) >= kMinSamples &&
         correlation >= (is_confirmed_ ? kMinCorrelation : kMinCorrelationAgain) &&
         explanation.prior_cost <= 0.5 * kMaxSigmas * kMaxSigmas;
}

int BlurJudge::num_supporting(const Explanation& explanation, const TagVotes& votes) const {
  return std::max(num_explained(trusted_tags(explanation, votes)), votes.agreeing);
}

void BlurJudge::claimed(const Explanation& explanation, const TagVotes& votes) {
  contrasts_.remember(trusted_tags(explanation, votes));
  is_confirmed_ = is_confirmed_ || votes.agreeing > 0;
}

std::vector<TagEvidence> BlurJudge::trusted_tags(const Explanation& explanation,
                                                 const TagVotes& votes) const {
  std::vector<TagEvidence> tags = explanation.fit.tags;
  if (votes.agreeing == 0) contrasts_.doubt(tags);
  return tags;
}

}  // namespace apriltrack
