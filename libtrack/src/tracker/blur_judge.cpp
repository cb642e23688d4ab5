#include "blur_judge.h"

#include <algorithm>

namespace apriltrack {
namespace {

constexpr double kMinCorrelationWithDetection = 0.5;
// Found again without a detection: a wide search also finds what merely looks like a blurred tag. It reached
// 0.95, and 11 standard deviations of the motion, before a wall of patches; right states reached 7.5 of them.
constexpr double kMinCorrelationAgain = 0.95;
// After a longer time without evidence the motion's prior is too wide to hold a claim: it is found again.
constexpr double kMaxFollowed_s = 0.1;
// Where the motion so far does not say within a tag where a tag is, its neighbours and what hangs beside
// it lie as near: then one tag alone is not enough.
constexpr double kMaxSpreadAlone = 1.0;
// From here on one of a tag's own stripes may lie on another's place: then what should be seen beside a lone
// tag and is not counts against it.
constexpr double kMaxSpreadOutweighed = 0.3;
// Of what a claim without a detection rests on: a sliver of a border fits nearly any edge.
constexpr double kMinSamples = 40.0;

std::ptrdiff_t num_explained(const std::vector<TagEvidence>& tags) {
  return std::ranges::count_if(tags, &TagEvidence::is_explained);
}

/// The contrast that the tags would have at a sensitivity of 1.
std::vector<TagEvidence> per_gathered_light(std::vector<TagEvidence> tags, double sensitivity) {
  for (TagEvidence& tag : tags) tag.contrast /= sensitivity;
  return tags;
}

/// As they are seen: a wide search finds too much where noise is an excuse.
std::vector<TagEvidence> with_noise(std::vector<TagEvidence> tags) {
  for (TagEvidence& tag : tags) tag.noise_share = 0.0;
  return tags;
}

/// Of what the evidence alone expects: a turn that was seen may have been something near.
double cost_by_evidence(const Explanation& explanation) {
  if (!explanation.prior.unaided) return explanation.prior_cost;
  return prior_cost(*explanation.prior.unaided, explanation.fit.state);
}

double samples_of_explained(const std::vector<TagEvidence>& tags) {
  double sum = 0.0;
  for (const TagEvidence& tag : tags) sum += tag.is_explained() ? tag.independent_samples() : 0.0;
  return sum;
}

/// Less is explained than is not.
bool is_outweighed(const std::vector<TagEvidence>& tags) {
  double explained_px = 0.0, unexplained_px = 0.0;
  for (const TagEvidence& tag : tags) (tag.is_explained() ? explained_px : unexplained_px) += tag.area_px;
  return unexplained_px > explained_px;
}

}  // namespace

bool BlurJudge::is_convincing(const Explanation& explanation, const std::optional<double>& interval_s) const {
  const TagVotes& votes = explanation.votes;
  if (num_supporting(explanation) <= static_cast<int>(votes.contradicting.size())) return false;
  if (explanation.is_beyond_prior()) return false;
  // Against a motion that is known, most of what should be seen must be: not the few that nothing covers.
  if (explanation.is_cold && interval_s &&
      typical_correlation(explanation.fit.tags) < TagEvidence::kExplained)
    return false;
  const std::vector<TagEvidence> tags = quorum(trusted_tags(explanation), votes);
  if (!votes.agreeing.empty()) return typical_correlation(tags) >= kMinCorrelationWithDetection;
  if (explanation.is_cold) return false;  // it began at a detection, and does not agree with any
  if (num_explained(tags) < 2 && explanation.prior_spread > kMaxSpreadAlone) return false;
  if (num_explained(tags) < 2 && explanation.prior_spread > kMaxSpreadOutweighed &&
      is_outweighed(explanation.fit.tags))
    return false;
  const bool is_followed = is_confirmed_ && interval_s && *interval_s <= kMaxFollowed_s;
  // A lone tag found again must also be where the motion expects it: what was found eight standard deviations
  // off, before that wall, reached 0.96.
  if (!is_followed && num_explained(tags) < 2 && !(cost_by_evidence(explanation) <= kMaxExpectedPriorCost))
    return false;
  return samples_of_explained(tags) >= kMinSamples &&
         (is_followed ? typical_correlation(tags) >= TagEvidence::kExplained
                      : typical_correlation(with_noise(tags)) >= kMinCorrelationAgain);
}

int BlurJudge::num_supporting(const Explanation& explanation) const {
  const std::vector<int>& agreeing = explanation.votes.agreeing;
  const std::vector<TagEvidence> tags = trusted_tags(explanation);
  const auto is_explained_only = [&](const TagEvidence& tag) {
    return tag.is_explained() && std::ranges::count(agreeing, tag.tag_index) == 0;
  };
  return static_cast<int>(agreeing.size()) + static_cast<int>(std::ranges::count_if(tags, is_explained_only));
}

void BlurJudge::claimed(const Explanation& explanation) {
  const std::vector<TagEvidence> tags = trusted_tags(explanation);
  contrasts_.remember(tags, explanation.R_light_map);
  radiances_.remember(per_gathered_light(tags, explanation.sensitivity), explanation.R_light_map);
  is_confirmed_ = is_confirmed_ || !explanation.votes.agreeing.empty();
}

std::vector<TagEvidence> BlurJudge::trusted_tags(const Explanation& explanation) const {
  std::vector<TagEvidence> tags = explanation.fit.tags;
  if (!explanation.votes.agreeing.empty()) return tags;
  std::vector<TagEvidence> by_radiance = per_gathered_light(tags, explanation.sensitivity);
  contrasts_.doubt(tags, explanation.R_light_map);
  radiances_.doubt(by_radiance, explanation.R_light_map);
  for (std::size_t i = 0; i < tags.size(); ++i)
    tags[i].correlation = std::max(tags[i].correlation, by_radiance[i].correlation);
  return tags;
}

}  // namespace apriltrack
