#pragma once

#include <set>
#include <vector>

#include "apriltrack/base/parallel.h"
#include "initialise/part_adjustment.h"

namespace apriltrack {

/// Of a tag that was found at two places and another, or a board of them, that alone joins them (rival_tags)
/// neither can be trusted: both are left out, the map is solved without, and each is told with the doubt. A
/// tag that the user holds stays, and where several in a row join them, any of which may be it, they stay,
/// too: that the map may be folded is told. Throws NothingLeft where too little is left.
void leave_out_rivals(const PartTask& task, const Part& part, AdjustedPart& solved,
                      const ParallelFor& parallel);

/// The finding with the tags that may be at fault in its place, where there is no map. known: what was found
/// before.
TagFinding with_rivals(const PartTask& task, const Part& part, const AdjustedPart& solved,
                       const std::vector<TagFinding>& known, TagFinding finding);

}  // namespace apriltrack
