#pragma once

#include <vector>

#include "start_fit.h"

namespace apriltrack {

// States that look as the best explanation found does, about. Each is added to `found`, which is not empty
// and best first, before and after.

/// The other tilt of a lone tag, where the motion so far does not rule it out. has_asked_corners: the poses
/// that its corners allow are in `found` where it was read, both tilts among them.
void add_mirrored_tilt(const StartFit& start_fit, const BlurFrame& frame, bool has_asked_corners,
                       std::vector<Explanation>& found);

/// The path's reverse, where the next frame could tell the two apart.
void add_reversed_path(const StartFit& start_fit, const BlurFrame& frame, std::vector<Explanation>& found);

}  // namespace apriltrack
