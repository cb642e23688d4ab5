#pragma once

#include <set>

#include "observations/observations.h"

namespace apriltrack {

/// Takes out views of moments that show, to the last digit, what an earlier one shows: a film that stands
/// still, or a file read twice, is one picture, however long it is. How many moments those were.
/// kept: times of moments that stay.
int drop_repeated_frames(Observations& observations, const std::set<Timestamp>& kept = {});

}  // namespace apriltrack
