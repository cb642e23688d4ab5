#pragma once

#include <string>
#include <vector>

#include "observations.h"
#include "parts.h"

namespace apriltrack {

/// What to say of two tags of the map that some frames show together, none of which fits, where one tag alone
/// joins the two in what the map rests on: if those frames are right, that one hangs twice or was moved, the
/// map is folded at it, and nothing else can show it. offered: the views before outliers were removed; kept:
/// those that the map rests on.
std::vector<std::string> words_of_lost_links(const Observations& observations, const Part& offered,
                                             const Part& kept);

}  // namespace apriltrack
