#pragma once

#include <vector>

#include "start_fit.h"

namespace apriltrack {

/// A tag a little off its place pulls the whole pose to where a stripe of it fits as well as may be, and is
/// not explained there. Where the best explanation leaves tags in view unexplained and others not, fits these
/// others alone, and then all of them from there. found: best first, not empty; so afterwards.
void explain_tags_that_pull(const StartFit& start_fit, const BlurFrame& frame,
                            std::vector<Explanation>& found);

}  // namespace apriltrack
