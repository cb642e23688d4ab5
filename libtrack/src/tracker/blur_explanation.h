#pragma once

#include <vector>

#include "start_fit.h"

namespace apriltrack {

/// Finds the states that explain frames: from the motion so far, from detections, and from a cloud of
/// particles where neither does.
class BlurExplainer {
 public:
  BlurExplainer(PhotometricWorld& world, const BlurTrackerOptions& options) : start_fit_(world, options) {}

  /// Best first; empty when there is neither a hypothesis nor a detection. hypotheses: of this frame's time,
  /// the likeliest first.
  std::vector<Explanation> explain(const BlurFrame& frame,
                                   const std::vector<MotionHypothesis>& hypotheses) const;

 private:
  std::vector<Explanation> explain_all(const BlurFrame& frame,
                                       const std::vector<MotionHypothesis>& hypotheses) const;

  StartFit start_fit_;
};

}  // namespace apriltrack
