#pragma once

#include <vector>

#include "initialise/part_adjustment.h"

namespace apriltrack {

/// Takes tags out of `solved` of which more than half of the views were rejected, and adjusts the others
/// anew: where the few that are left put such a tag, most of what was seen of it says otherwise. The tag that
/// the user holds stays, and all stay where too little would be left. part: before outliers were removed.
/// Which they were, in order.
std::vector<int> leave_out_contradicted(const PartTask& task, const Part& part, AdjustedPart& solved);

}  // namespace apriltrack
