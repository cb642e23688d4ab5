#pragma once

#include <vector>

#include "start_fit.h"

namespace apriltrack {

/// Adds what clouds of particles find about the hypotheses, or about cold starts where there are none, until
/// something explains the frame well: one cloud, and a larger one where the first finds too little and the
/// motion still tells where to look.
///
/// found: not empty, best first; so afterwards.
void search_widely(const StartFit& start_fit, const BlurFrame& frame,
                   const std::vector<MotionHypothesis>& hypotheses, std::vector<Explanation>& found);

}  // namespace apriltrack
