#include "motion_memory.h"

#include <utility>

namespace apriltrack {

std::optional<double> MotionMemory::age_s(Timestamp time) const {
  const double age_s = seconds_between(time_, time);
  if (hypotheses_.empty() || !(age_s > 0.0 && age_s <= max_age_s_)) return std::nullopt;
  return age_s;
}

std::vector<MotionHypothesis> MotionMemory::predict(Timestamp time, double speed_sigma) const {
  std::vector<MotionHypothesis> expected;
  const std::optional<double> dt_s = age_s(time);
  if (!dt_s) return expected;
  for (const MotionHypothesis& hypothesis : hypotheses_) {
    expected.push_back({apriltrack::predict(hypothesis.belief, noise_, *dt_s), hypothesis.log_odds});
    MotionBelief& belief = expected.back().belief;
    const Vector6d step = speed_sigma * *dt_s * belief.mean.velocity;
    belief.covariance.topLeftCorner<6, 6>() += step * step.transpose();
  }
  return expected;
}

void MotionMemory::remember(Timestamp time, std::vector<MotionHypothesis> hypotheses, double speed) {
  time_ = time;
  hypotheses_ = std::move(hypotheses);
  for (MotionHypothesis& hypothesis : hypotheses_) {
    hypothesis.belief.mean.velocity *= speed;
    hypothesis.belief.covariance.rightCols<6>() *= speed;
    hypothesis.belief.covariance.bottomRows<6>() *= speed;
  }
}

}  // namespace apriltrack
