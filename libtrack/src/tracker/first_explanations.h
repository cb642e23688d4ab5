#pragma once

#include <vector>

#include "start_fit.h"

namespace apriltrack {

/// From what the motion so far predicts: the likeliest, and the others where it settles nothing. Best first.
std::vector<Explanation> explain_by_motion(const StartFit& start_fit, const BlurFrame& frame,
                                           const std::vector<MotionHypothesis>& hypotheses);

/// Adds those that begin at the poses that detected corners allow. found: best first, before and after.
void add_detected(const StartFit& start_fit, const BlurFrame& frame,
                  const std::vector<MotionHypothesis>& hypotheses, std::vector<Explanation>& found);

/// The motion went on as expected, the tags look as they should, and every detection agrees: no other start
/// is needed.
bool is_settled(const BlurFrame& frame, const Explanation& explanation);

}  // namespace apriltrack
