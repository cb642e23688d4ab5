#pragma once

#include <set>
#include <vector>

#include "apriltrack/base/parallel.h"
#include "faults/tag_fault.h"

namespace apriltrack {

/// At all views of the tag in `part`, outliers too.
TagLook look_by(const PartTask& task, const Part& part, const AdjustedPart& solved, int tag);

/// Tags that are not `known` to be at fault: those with a fault that can be named, those whose views no
/// fault explains as the map is, and those of which many views were rejected, with frames that might have
/// told why; worst first.
std::vector<int> suspects_in(const PartTask& task, const Part& part, const AdjustedPart& solved,
                             const std::set<int>& known, const ParallelFor& parallel);

/// Whether the frames that show the tag fit worse than others do in the map with it: a tag that has no place
/// cannot be mapped without that, where one that others foretell badly can. True of one that is not mapped.
bool does_disturb(const PartTask& task, const Part& part, const AdjustedPart& solved, int tag);

}  // namespace apriltrack
