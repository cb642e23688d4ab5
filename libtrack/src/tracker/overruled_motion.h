#pragma once

#include <vector>

#include "start_fit.h"

namespace apriltrack {

// A frame may show, beyond doubt, what the motion so far rules out: then a claim before was wrong, or
// something hit the camera.

/// The best explanation is that of the motion so far, and another, which it rules out, scores far better.
/// found: best first, not empty.
bool is_overruled(const std::vector<Explanation>& found);

/// Explains such a frame once more, at the better place and without the motion so far, where detections hold
/// it. found: best first, not empty; so afterwards.
void start_over_where_overruled(const StartFit& start_fit, const BlurFrame& frame,
                                std::vector<Explanation>& found);

}  // namespace apriltrack
