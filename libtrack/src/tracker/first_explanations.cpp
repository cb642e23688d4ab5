#include "first_explanations.h"

#include <algorithm>
#include <cstddef>

#include "motion_start.h"
#include "pose_candidate.h"

namespace apriltrack {
namespace {

/// On a coarse level: of 684 fits that ended well, 10 had less there, of 281 others one in twenty had more.
constexpr double kLeastCorrelationCoarse = 0.5;
constexpr std::size_t kMaxCandidates = 8;
constexpr double kLogOddsOfFalseTurn = -3.0;  // one in twenty

/// What was seen to turn was something near.
MotionHypothesis without_turn(const MotionHypothesis& hypothesis) {
  return {*hypothesis.unaided, hypothesis.log_odds + kLogOddsOfFalseTurn};
}

/// At a pose that corners allow, with the velocities that the hypotheses expect there; cold where none does.
std::vector<MotionStart> starts_at(const PhotometricWorld& world, const PoseCandidate& candidate,
                                   const std::vector<MotionHypothesis>& hypotheses) {
  std::vector<MotionStart> starts;
  const Pose pose = pose_from_camera(candidate.T_camera_map, world.mode);
  for (const MotionHypothesis& hypothesis : hypotheses) {
    if (const auto state = conditioned(hypothesis.belief, pose)) {
      starts.push_back({*state, hypothesis, false});
    } else if (hypothesis.unaided) {
      const MotionHypothesis unaided = without_turn(hypothesis);
      if (const auto expected = conditioned(unaided.belief, pose))
        starts.push_back({*expected, unaided, false});
    }
  }
  if (!starts.empty()) return starts;
  // A detection that the motion so far did not expect pays as much as any surprise may cost.
  const double log_odds = hypotheses.empty() ? 0.0 : -kMaxScoredPriorCost;
  if (const auto cold = cold_belief(world, candidate))
    starts.push_back({cold->mean, {*cold, log_odds}, true});
  return starts;
}

/// One tag alone is explained, another should be seen but is not, and a detection can tell: it may be tilted
/// wrongly.
bool is_tilt_doubtful(const BlurFrame& frame, const Explanation& explanation) {
  const std::vector<TagEvidence>& tags = explanation.fit.tags;
  return !frame.observations.empty() && std::ranges::any_of(tags, is_missed) &&
         std::ranges::count_if(tags, &TagEvidence::is_explained) == 1;
}

std::vector<PoseCandidate> candidates_near(const StartFit& start_fit, const BlurFrame& frame,
                                           const std::vector<MotionHypothesis>& hypotheses) {
  const PhotometricWorld& world = start_fit.world();
  std::vector<Pose> predictions;
  for (const MotionHypothesis& hypothesis : hypotheses)
    predictions.push_back(camera_from_map(hypothesis.belief.mean.pose, world.mode));
  std::vector<PoseCandidate> found = find_pose_candidates(world.model, frame.observations, predictions, {});
  // Where no two tags agree, each brings its own, and its mirror's: no fit of pixels tells more of them.
  if (found.size() > kMaxCandidates) {
    std::ranges::stable_sort(found, {}, [&](const PoseCandidate& candidate) {
      return misfit(world.model, frame.observations, 1.0, candidate.T_camera_map);
    });
    found.resize(kMaxCandidates);
  }
  return found;
}

}  // namespace

std::vector<Explanation> explain_by_motion(const StartFit& start_fit, const BlurFrame& frame,
                                           const std::vector<MotionHypothesis>& hypotheses) {
  std::vector<Explanation> found;
  const auto is_settled_from = [&](const MotionHypothesis& prior) {
    found.push_back(start_fit.explained(frame, {prior.belief.mean, prior, false},
                                        {.least_correlation = kLeastCorrelationCoarse}));
    return is_settled(frame, found.back());
  };
  for (const MotionHypothesis& hypothesis : hypotheses) {
    if (is_settled_from(hypothesis)) break;
    // What was seen to turn may have been something near.
    if (!hypothesis.unaided || (found.back().is_explained() && is_where_seen(found.back()))) continue;
    if (is_settled_from(without_turn(hypothesis))) break;
  }
  sort_by_score(found);
  return found;
}

void add_detected(const StartFit& start_fit, const BlurFrame& frame,
                  const std::vector<MotionHypothesis>& hypotheses, std::vector<Explanation>& found) {
  if (frame.observations.empty()) return;
  const std::vector<PoseCandidate> candidates = candidates_near(start_fit, frame, hypotheses);
  const auto explain_from = [&](const std::vector<MotionHypothesis>& motions) {
    for (const PoseCandidate& candidate : candidates) {
      for (const MotionStart& start : starts_at(start_fit.world(), candidate, motions))
        found.push_back(start_fit.explained(frame, start, {}));
    }
  };
  explain_from(hypotheses);
  if (!candidates.empty() && std::ranges::all_of(found, &Explanation::is_beyond_prior)) {
    found.clear();  // the motion so far was mistaken
    explain_from({});
  }
  sort_by_score(found);
}

bool is_settled(const BlurFrame& frame, const Explanation& explanation) {
  return is_well_explained(explanation) && explanation.prior_cost <= kMaxExpectedPriorCost &&
         !is_tilt_doubtful(frame, explanation) &&
         std::ranges::all_of(frame.observations, [&](const TagObservation& seen) {
           return std::ranges::count(explanation.votes.agreeing, seen.tag_index) > 0;
         });
}

}  // namespace apriltrack
