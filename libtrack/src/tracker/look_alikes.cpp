#include "look_alikes.h"

#include <optional>
#include <utility>

#include "motion_start.h"
#include "path_bend.h"

namespace apriltrack {
namespace {

/// Of the next frame's motion noise: nearer than this, the path and its reverse lead to the same place.
constexpr double kMinReversedDistance = 1.0;
constexpr double kMinReversedPath_px = 2.0;
/// A tilt that is better found more of the motion, perhaps, which the other has not tried yet.
constexpr int kMaxRoundsOfTilts = 3;
/// A motion that goes on as expected keeps its tilt, unless the other is better by more than models err by.
constexpr double kLogOddsAgainstSettled = -6.0;

/// None where more than one tag is explained, where a detection brought both tilts along, or where a motion
/// that goes on as expected rules the other out.
std::optional<MotionStart> mirrored_start(const PhotometricWorld& world, const Explanation& best,
                                          bool has_asked_corners) {
  const std::vector<TagEvidence> tags = explained_tags(best.fit.tags);
  if (tags.size() != 1) return std::nullopt;
  const Pose& T_map_tag = world.tag_at(tags.front().tag_index).tag.T_map_tag;
  const MotionState other = mirrored_state(best.fit.state, T_map_tag, world.mode);
  if (best.is_cold) {
    // Both tilts were looked at, at rest; but only one of them, perhaps, with this motion.
    MotionStart start{other, best.prior, true};
    start.prior.belief.mean = mirrored_state(best.prior.belief.mean, T_map_tag, world.mode);
    return start;
  }
  if (has_asked_corners && !best.votes.agreeing.empty()) return std::nullopt;
  const auto state = conditioned(best.prior.belief, other.pose);
  // A motion that costs more than usual by this tilt may be the other's.
  if (!state && best.prior_cost <= kUsualPriorCost) return std::nullopt;
  return MotionStart{state.value_or(other), best.prior, false};
}

}  // namespace

void add_mirrored_tilt(const StartFit& start_fit, const BlurFrame& frame, bool has_asked_corners,
                       std::vector<Explanation>& found) {
  const double log_odds = found.front().prior.log_odds;
  for (int round = 0; round < kMaxRoundsOfTilts; ++round) {
    const double score = found.front().score;
    auto start = mirrored_start(start_fit.world(), found.front(), has_asked_corners);
    if (!start) return;
    const bool is_first_tilt = round % 2 == 1;
    start->prior.log_odds = log_odds + (has_asked_corners || is_first_tilt ? 0.0 : kLogOddsAgainstSettled);
    found.push_back(start_fit.explained(frame, *start, {.coarsest_level = 1}));
    sort_by_score(found);
    if (found.front().score <= score) return;
  }
}

void add_reversed_path(const StartFit& start_fit, const BlurFrame& frame, std::vector<Explanation>& found) {
  const Explanation& best = found.front();
  if (longest_path_px(best) < kMinReversedPath_px) return;  // it does not blur
  const MotionBelief here{best.fit.state, Matrix12d::Zero()};
  MotionState state = best.fit.state;
  state.velocity = -state.velocity;  // and the same acceleration: the same places, in the other order
  const double interval_s = frame.interval_s.value_or(kUsualInterval_s);
  const MotionBelief next = predict(here, start_fit.options().motion_noise, interval_s);
  const MotionState other = predict(state, interval_s);
  if (distance(next, other.pose) < kMinReversedDistance) return;
  Explanation reversed = path_reversed(best);
  reversed.bend_covariance = start_fit.bend_covariance_of(frame, reversed);
  if (is_better(reversed, best))
    reversed = start_fit.explained(frame, {state, best.prior, best.is_cold}, {.coarsest_level = 0});
  found.push_back(std::move(reversed));
  sort_by_score(found);
}

}  // namespace apriltrack
