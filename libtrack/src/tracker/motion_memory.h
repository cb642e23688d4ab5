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
  /// run forward.
  std::vector<MotionHypothesis> predict(Timestamp time) const;
  /// Since the evidence; none where nothing is expected.
  std::optional<double> age_s(Timestamp time) const;

  /// hypotheses: the likeliest first.
  void remember(Timestamp time, std::vector<MotionHypothesis> hypotheses);
  void forget() { hypotheses_.clear(); }

 private:
  MotionNoise noise_;
  double max_age_s_;
  Timestamp time_;
  std::vector<MotionHypothesis> hypotheses_;
};

}  // namespace apriltrack
