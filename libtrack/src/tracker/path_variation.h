#pragma once

#include <vector>

#include "start_fit.h"

namespace apriltrack {

// Other paths beside that of the best explanation found: blur tells them apart badly, so that a fit may end
// at one for another. The best of each kind is added to `found` where its sketch is better.

/// At rest, and the path's reverse; of a cold start, turns of the camera each way. found: not empty, best
/// first; so afterwards.
void vary_velocity(const StartFit& start_fit, const BlurFrame& frame, std::vector<Explanation>& found);

/// Where the blur is long: shorter and longer paths, while one is better. found: likewise.
void vary_length(const StartFit& start_fit, const BlurFrame& frame, std::vector<Explanation>& found);

}  // namespace apriltrack
