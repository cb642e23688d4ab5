#include "tag_consensus.h"

#include <algorithm>
#include <iterator>

#include "blur_covariance.h"
#include "place_spread.h"

namespace apriltrack {
namespace {

/// Tags of a frame that may be left out, one at a time, until the others fit one pose.
constexpr int kMostLeftOut = 3;
/// Of doubts (frames, and chi2 over its limit): tags that are as doubtful cannot be told apart.
constexpr double kDoubtAlike = 0.5;
/// Standard deviations that a tag that never fitted another may be off the motion that others showed.
constexpr double kMaxSigmasOfUnknown = 6.0;
/// Standard deviations of a tag's place, in its sizes, from which on its neighbour may be taken for it.
constexpr double kMinSpreadOfMistakes = 0.3;
/// Nats, of each tag: right ones reached 24 and more in a page full of tags, another's 7.
constexpr double kMinIdentityLogOdds = 20.0;
/// What tags reach that are read and nothing hides.
constexpr double kLeastCorrelationOfRead = 0.94;
constexpr double kWeightOfMotion = 0.5;  // as a witness against a tag
/// What the place of a tag that a start should show and does not may be open by.
constexpr double kMaxSigmaOfMissed_px = 3.0;
constexpr double kMaxSigmaOfMissedFollowed_px = 10.0;
/// What is asked of tags that take no part: whether they are there, not where to a hundredth of a pixel.
constexpr int kPixelsOfHiddenTags = 250;

bool contains(const std::vector<int>& tags, int tag) {
  return std::ranges::count(tags, tag) > 0;
}

/// Those that speak for a state.
std::vector<int> supporting_tags(const Explanation& best) {
  std::set<int> tags(best.votes.agreeing.begin(), best.votes.agreeing.end());
  for (const TagEvidence& tag : best.fit.tags) {
    if (tag.is_explained()) tags.insert(tag.tag_index);
  }
  return {tags.begin(), tags.end()};
}

}  // namespace

void TagConsensus::begin_frame() {
  left_out_.clear();
  num_examined_ = 0;
  is_torn_ = false;
  tags_.clear();
  strains_.clear();
}

void TagConsensus::choose(BlurFrame& frame, bool with_hidden) {
  frame.observations.clear();
  std::ranges::copy_if(frame.read, std::back_inserter(frame.observations),
                       [&](const TagObservation& seen) { return !is_left_out(seen.tag_index); });
  unmark();
  if (with_hidden)
    hidden_.mark_doubted(world_, frame.observations);
  else
    hidden_.mark(world_, frame.observations);
  doubted_ = trust_.suspects();
  doubted_.insert(left_out_.begin(), left_out_.end());
  for (const int index : doubted_) world_.tag_at(index).is_hidden = true;
}

void TagConsensus::unmark() {
  for (const int index : doubted_) world_.tag_at(index).is_hidden = false;
  doubted_.clear();
  hidden_.unmark(world_);
}

bool TagConsensus::leaves_one_out(const BlurFrame& frame, const Explanation& best) {
  tags_ = best.fit.equations;
  std::ranges::copy(equations_by_tag(world_, frame.photometric, best.fit.state,
                                     {.max_pixels_per_tag = kPixelsOfHiddenTags, .tags = TagChoice::kHidden}),
                    std::back_inserter(tags_));
  strains_ = tag_strains(world_, best.fit.state, tags_);
  const std::vector<Doubted> doubted = doubted_tags();
  if (doubted.empty()) return false;
  is_torn_ = num_examined_++ == kMostLeftOut || doubted[0].doubt < doubted[1].doubt + kDoubtAlike;
  if (!is_torn_)
    left_out_.insert(doubted[0].tag_index);
  else if (is_told_of(frame, best, doubted[0].tag_index) && is_told_of(frame, best, doubted[1].tag_index))
    trust_.disagree({doubted[0].tag_index}, {doubted[1].tag_index});
  return !is_torn_;
}

/// A tag that a start has somewhere, and nobody read, may look like it by chance: that speaks against no
/// other.
bool TagConsensus::is_told_of(const BlurFrame& frame, const Explanation& best, int tag_index) {
  return !best.is_cold ||
         std::ranges::find(frame.read, tag_index, &TagObservation::tag_index) != frame.read.end();
}

/// Those that may be the reason of a strain, the most doubtful first; none where there is no strain.
std::vector<TagConsensus::Doubted> TagConsensus::doubted_tags() const {
  std::vector<Doubted> doubted;
  bool is_strained = false;
  const auto num_in_fit =
      std::ranges::count_if(strains_, [&](const TagStrain& strain) { return is_in_fit(strain); });
  for (const TagStrain& strain : strains_) {
    if (!is_in_fit(strain)) continue;
    is_strained = is_strained || strain.is_strained();
    // Two tags are strained by one another, whatever their size.
    const double of_frame = num_in_fit > 2 ? strain.chi2 / TagStrain::kMaxChi2 : 0.0;
    doubted.push_back({strain.tag_index, of_frame + trust_.doubt(strain.tag_index)});
  }
  if (!is_strained || doubted.size() < 2) return {};
  std::ranges::stable_sort(doubted, std::greater(), &Doubted::doubt);
  return doubted;
}

std::vector<int> TagConsensus::strained_tags() const {
  std::vector<int> tags;
  for (const TagStrain& strain : strains_) {
    if (strain.is_strained()) tags.push_back(strain.tag_index);
  }
  return tags;
}

std::string TagConsensus::objection(const BlurFrame& frame, const Explanation& best,
                                    const std::vector<MotionHypothesis>& expected) {
  if (is_torn_) return "the tags seen do not agree on a pose";
  if (is_read_by_chance(best))
    return "a tag of so few bits that chance may read it, and none beside that agrees";
  if (is_vague(best))
    return "one far tag alone does not tell its tilt, and another is not seen where it has it";
  if (jumps_alone(best, expected))
    return "one tag alone, where the motion that others showed does not expect it";
  if (may_be_mistaken(frame, best)) return "too blurred to tell which of several tags is seen";
  return {};
}

/// A start from a far tag alone: its tilt, and with it the place of all others, is known to degrees only.
/// Where these are not where it has them, nothing says which of its tilts is right.
bool TagConsensus::is_vague(const Explanation& best) const {
  return best.is_cold && leaves_open_what_is_missed(best, kMaxSigmaOfMissed_px);
}

/// No tag of these is read for sure, nor are two read that look it; nor does a motion go on that rests on a
/// tag that once was, or that was seen to fit another.
bool TagConsensus::is_read_by_chance(const Explanation& best) const {
  if (!best.is_cold && best.votes.agreeing.empty())
    return false;  // it goes on by itself, from what was claimed
  const bool is_known = std::ranges::any_of(supporting_tags(best), [&](int tag) {
    return readings_.is_surely_read_now(tag) ||
           (!best.is_cold && (trust_.is_confirmed(tag) || readings_.was_surely_read(tag)));
  });
  const auto looks_read = [&](const TagEvidence& tag) {
    return contains(best.votes.agreeing, tag.tag_index) && tag.clean_correlation() >= kLeastCorrelationOfRead;
  };
  return !is_known && std::ranges::count_if(best.fit.tags, looks_read) < 2;
}

bool TagConsensus::is_doubtful(const Explanation& best) const {
  return best.votes.agreeing.empty() && (leaves_open_what_is_missed(best, kMaxSigmaOfMissedFollowed_px) ||
                                         rests_on_part_of_a_tag(best) || surprises_alone(best));
}

/// Whether a tag that should be seen is not, and the others do not say where it is.
bool TagConsensus::leaves_open_what_is_missed(const Explanation& best, double max_sigma_px) const {
  const Matrix6d covariance = fit_covariance(world_, best.fit).topLeftCorner<6, 6>() + best.bend_covariance;
  return std::ranges::any_of(best.fit.tags, [&](const TagEvidence& tag) {
    if (!is_missed(tag)) return false;
    const PhotometricTag& missed = world_.tag_at(tag.tag_index);
    return !(place_sigma_px(world_, missed, best.fit.state.pose, covariance) <= max_sigma_px);
  });
}

/// A tag that never fitted another, alone where the motion that others showed does not expect it.
bool TagConsensus::jumps_alone(const Explanation& best, const std::vector<MotionHypothesis>& expected) {
  const std::vector<int> supporting = supporting_tags(best);
  if (expected.empty() || supporting.size() != 1 || trust_.is_confirmed(supporting.front())) return false;
  if (witnesses_.empty() || contains(witnesses_, supporting.front())) return false;
  const bool is_expected = std::ranges::any_of(expected, [&](const MotionHypothesis& hypothesis) {
    return distance(hypothesis.by_evidence(), best.fit.state.pose) < kMaxSigmasOfUnknown;
  });
  if (!is_expected) trust_.disagree(witnesses_, supporting, kWeightOfMotion);
  return !is_expected;
}

/// Where the motion leaves open which of several tags it is, and none was read: whether the pictures of the
/// tags that speak for the state are any better than what all tags have in common.
bool TagConsensus::may_be_mistaken(const BlurFrame& frame, const Explanation& best) const {
  if (!best.votes.agreeing.empty() || best.prior_spread < kMinSpreadOfMistakes) return false;
  std::vector<TagEvidence> explained = best.fit.tags;
  std::erase_if(explained, [](const TagEvidence& tag) { return !tag.is_explained(); });
  return identity_log_odds(world_, frame.photometric, best.fit.state, explained) <
         kMinIdentityLogOdds * static_cast<double>(explained.size());
}

void TagConsensus::learn(const BlurFrame& frame, const Explanation& best, bool has_rival) {
  witnesses_ = supporting_tags(best);
  std::vector<int> right;
  for (const TagStrain& strain : strains_) {
    if (strain.is_right()) right.push_back(strain.tag_index);
  }
  trust_.agree(right);
  std::set<int> others(left_out_);
  for (const int tag : strained_tags()) others.insert(tag);
  for (const int tag : votes_of_all_read(frame, best).contradicting) others.insert(tag);
  trust_.disagree(witnesses_, {others.begin(), others.end()});
  learn_hidden_tags(frame, best, has_rival);
}

void TagConsensus::learn_contradictions(const Explanation& best) {
  if (!is_torn_) trust_.disagree(best.votes.agreeing, best.votes.contradicting);
}

void TagConsensus::learn_hidden_tags(const BlurFrame& frame, const Explanation& best, bool has_rival) {
  std::vector<TagEvidence> tags;
  std::ranges::transform(tags_, std::back_inserter(tags), &TagEquations::evidence);
  discredit_tags_read_as_others(world_, frame.detections, best.fit.state, best.votes, tags);
  hidden_.learn(tags, best.votes, !best.is_cold && !best.votes.agreeing.empty() && !has_rival);
}

/// Suspects, too.
TagVotes TagConsensus::votes_of_all_read(const BlurFrame& frame, const Explanation& best) const {
  return count_votes(world_, frame.read, best.fit.state, frame.photometric.exposure_s,
                     options_.corner_sigma_px);
}

void TagConsensus::report(const BlurFrame& frame, const Explanation& best, TrackResult& result) const {
  const TagVotes votes = votes_of_all_read(frame, best);
  std::set<int> contradicting(votes.contradicting.begin(), votes.contradicting.end());
  for (const TagEquations& tag : tags_) {
    result.tags.push_back(report_of(frame, tag.evidence, votes));
    if (is_left_out(tag.evidence.tag_index)) contradicting.insert(tag.evidence.tag_index);
  }
  for (const int index : contradicting) result.contradicting_tags.push_back(world_.tag_at(index).tag.key);
}

TagReport TagConsensus::report_of(const BlurFrame& frame, const TagEvidence& evidence,
                                  const TagVotes& votes) const {
  const int index = evidence.tag_index;
  TagReport report;
  report.tag = world_.tag_at(index).tag.key;
  report.state = state_of(evidence, votes);
  report.correlation = evidence.clean_correlation();
  report.found_share = evidence.correlation * evidence.correlation;
  report.expected_share = 1.0 - evidence.noise_share;
  report.log_odds = evidence.log_likelihood();
  report.is_read = std::ranges::count(frame.read, index, &TagObservation::tag_index) > 0;
  const auto strain = std::ranges::find(strains_, index, &TagStrain::tag_index);
  if (strain != strains_.end()) report.shift_px = strain->shift_px;
  return report;
}

TagState TagConsensus::state_of(const TagEvidence& evidence, const TagVotes& votes) const {
  const int index = evidence.tag_index;
  if (is_left_out(index)) return TagState::kSuspect;
  if (contains(votes.contradicting, index)) return TagState::kElsewhere;
  if (world_.tag_at(index).is_hidden) return TagState::kHidden;
  return evidence.is_explained() || contains(votes.agreeing, index) ? TagState::kUsed : TagState::kOccluded;
}

}  // namespace apriltrack
