#pragma once

#include <string>
#include <vector>

#include "blur_frame.h"
#include "explanation.h"

namespace apriltrack {

/// Why a frame gives no pose: the words of TrackResult::reason. found: its explanations, none of which
/// convinces, best first.
std::string lost_reason(const BlurFrame& frame, const std::vector<Explanation>& found);

}  // namespace apriltrack
