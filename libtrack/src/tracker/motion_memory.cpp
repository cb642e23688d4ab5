#include "motion_memory.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

namespace apriltrack {
namespace {

/// One step after `known`, as the motion alone expects it.
MotionHypothesis stepped(const MotionHypothesis& known, const MotionStep& step) {
  MotionHypothesis next{predicted(known.belief, step), known.log_odds};
  if (known.unaided) next.unaided = predicted(*known.unaided, step);
  return next;
}

MotionHypothesis stepped(const MotionHypothesis& known, const MotionStep& step, const SeenTurn& turn) {
  TurnedBelief turned = turned_by(known.belief, step, turn);
  return {std::move(turned.belief), known.log_odds + turned.log_likelihood,
          predicted(known.by_evidence(), step), turned.is_believed, turned.velocity_before};
}

}  // namespace

std::optional<double> MotionMemory::age_s(Timestamp time) const {
  const double age_s = seconds_between(evidence_time_, time);
  if (hypotheses_.empty() || !(age_s > 0.0 && age_s <= max_age_s_)) return std::nullopt;
  return age_s;
}

std::optional<double> MotionMemory::step_s(Timestamp time) const {
  if (!age_s(time)) return std::nullopt;
  return seconds_between(time_, time);
}

std::vector<MotionHypothesis> MotionMemory::predict(Timestamp time, double speed_sigma,
                                                    const std::optional<SeenTurn>& turn) const {
  std::vector<MotionHypothesis> expected;
  const std::optional<double> dt_s = step_s(time);
  if (!dt_s) return expected;
  // What velocities may be off by is the same in all steps: poses are off by its sum, not by that of squares.
  const double before_s = *age_s(time) - *dt_s;
  const double share = std::sqrt(1.0 + 2.0 * before_s / *dt_s);
  const MotionStep step{noise_, *dt_s, share * speed_sigma};
  for (const MotionHypothesis& known : hypotheses_)
    expected.push_back(turn ? stepped(known, step, *turn) : stepped(known, step));
  std::ranges::stable_sort(expected, std::greater(), &MotionHypothesis::log_odds);
  const double best = expected.front().log_odds;
  for (MotionHypothesis& hypothesis : expected) hypothesis.log_odds -= best;
  return expected;
}

void MotionMemory::remember(Timestamp time, std::vector<MotionHypothesis> hypotheses, double speed) {
  evidence_time_ = time_ = time;
  hypotheses_ = std::move(hypotheses);
  for (MotionHypothesis& hypothesis : hypotheses_) {
    hypothesis.belief.mean.velocity *= speed;
    hypothesis.belief.covariance.rightCols<6>() *= speed;
    hypothesis.belief.covariance.bottomRows<6>() *= speed;
  }
}

void MotionMemory::step(Timestamp time, std::vector<MotionHypothesis> expected) {
  time_ = time;
  hypotheses_ = std::move(expected);
}

}  // namespace apriltrack
