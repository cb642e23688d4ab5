#pragma once

#include <vector>

#include "apriltrack/eval/evaluate_trajectory.h"

namespace apriltrack {

/// Bins without a frame are left out.
std::vector<BlurBin> bin_by_blur(const std::vector<FrameScore>& frames);

}  // namespace apriltrack
