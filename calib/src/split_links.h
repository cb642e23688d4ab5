#pragma once

#include <string>
#include <vector>

#include "part_adjustment.h"

namespace apriltrack {

/// What to say of a tag that alone joins others to the map, where some frames that show it with another agree
/// with each other, but not with the map: if they are right, it hangs twice or was moved, the map may be
/// folded at it, and nothing else can show it. offered: the views before outliers were removed; kept: those
/// that the map rests on; state: of the map.
std::vector<std::string> words_of_split_links(const PartTask& task, const Part& offered, const Part& kept,
                                              const MapState& state);

}  // namespace apriltrack
