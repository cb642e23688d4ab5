#pragma once

#include <vector>

#include "observations/parts.h"

namespace apriltrack {

/// Groups of tags that may lie wrongly as one body: each tag alone, and what hangs on each link of the
/// spanning tree of greatest weight (frames that show both tags, large ones count more), the smaller side.
/// Each sorted; smallest groups first.
std::vector<std::vector<int>> hinged_groups(const Observations& observations, const Part& part);

}  // namespace apriltrack
