#pragma once

#include <optional>
#include <vector>

#include "apriltrack/base/timestamp.h"
#include "apriltrack/motion/motion_state.h"

namespace apriltrack {

/// One of the things that the motion so far may mean: a path and its reverse blur alike, and a lone tag may
/// be tilted either way.
struct MotionHypothesis {
  MotionBelief belief;
  double log_odds = 0.0;  ///< Over the likeliest; 0 for that one.
};

/// What the last frame with evidence said of the motion.
class MotionMemory {
 public:
  MotionMemory(const MotionNoise& noise, double max_age_s) : noise_(noise), max_age_s_(max_age_s) {}

  /// What is expected at `time`, the likeliest first; nothing when the evidence is too old, or time does not
  /// run forward. speed_sigma: of the logarithm of what all velocities may be off by together: the poses that
  /// they lead to are as uncertain.
  std::vector<MotionHypothesis> predict(Timestamp time, double speed_sigma = 0.0) const;
  /// Since the evidence; none where nothing is expected.
  std::optional<double> age_s(Timestamp time) const;

  /// hypotheses: the likeliest first. speed: what their velocities are to be multiplied by.
  void remember(Timestamp time, std::vector<MotionHypothesis> hypotheses, double speed = 1.0);
  void forget() { hypotheses_.clear(); }

 private:
  MotionNoise noise_;
  double max_age_s_;
  Timestamp time_;
  std::vector<MotionHypothesis> hypotheses_;
};

}  // namespace apriltrack
