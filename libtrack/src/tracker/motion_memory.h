#pragma once

#include <optional>
#include <vector>

#include "apriltrack/base/timestamp.h"
#include "apriltrack/motion/motion_state.h"
#include "seen_turn.h"

namespace apriltrack {

/// One of the things that the motion so far may mean: a path and its reverse blur alike, and a lone tag may
/// be tilted either way.
struct MotionHypothesis {
  MotionBelief belief;
  double log_odds = 0.0;  ///< Over the likeliest; 0 for that one.
  /// What the evidence alone leads to where `belief` also knows of turns that were seen since.
  std::optional<MotionBelief> unaided = {};
  bool agrees_with_turn = false;  ///< That was seen in the last step.
  /// What the velocity would be now, had it not changed in the last step; of `belief` where it has none.
  std::optional<Vector6d> velocity_before = {};

  const MotionBelief& by_evidence() const { return unaided ? *unaided : belief; }
  const Vector6d& expected_velocity() const {
    return velocity_before ? *velocity_before : belief.mean.velocity;
  }
};

/// What the last frame with evidence said of the motion, and the turns that were seen since.
class MotionMemory {
 public:
  MotionMemory(const MotionNoise& noise, double max_age_s) : noise_(noise), max_age_s_(max_age_s) {}

  /// What is expected at `time`, the likeliest first; nothing when the evidence is too old, or time does not
  /// run forward. speed_sigma: of the logarithm of what all velocities may be off by together: the poses that
  /// they lead to are as uncertain. turn: since the last evidence, or the last step without.
  std::vector<MotionHypothesis> predict(Timestamp time, double speed_sigma = 0.0,
                                        const std::optional<SeenTurn>& turn = {}) const;
  /// Since the evidence; none where nothing is expected.
  std::optional<double> age_s(Timestamp time) const;
  /// Since the evidence, or the last step without.
  std::optional<double> step_s(Timestamp time) const;
  /// The likeliest state of that very time; null where it was another that was remembered, or stepped to.
  const MotionState* at(Timestamp time) const {
    return hypotheses_.empty() || time_ != time ? nullptr : &hypotheses_.front().belief.mean;
  }

  /// hypotheses: the likeliest first. speed: what their velocities are to be multiplied by.
  void remember(Timestamp time, std::vector<MotionHypothesis> hypotheses, double speed = 1.0);
  /// A frame without evidence, but with a turn: what predict() made of it goes on from there.
  void step(Timestamp time, std::vector<MotionHypothesis> expected);

 private:
  MotionNoise noise_;
  double max_age_s_;
  Timestamp evidence_time_;
  Timestamp time_;  ///< Of the hypotheses: of the evidence, or of the last step since.
  std::vector<MotionHypothesis> hypotheses_;
};

}  // namespace apriltrack
