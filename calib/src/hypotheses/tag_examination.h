#pragma once

#include <vector>

#include "apriltrack/base/parallel.h"
#include "faults/tag_fault.h"

namespace apriltrack {

/// Holds every tag of the part against the others, names what is wrong with it, and takes tags out of
/// `solved` that would be wrong in the map. part: before outliers were removed. Also of
/// those that were left out before. Throws Error(kNoResult) where the tag that the user holds would be taken
/// out.
std::vector<TagFinding> examine_tags(const PartTask& task, const Part& part, AdjustedPart& solved,
                                     const ParallelFor& parallel);

}  // namespace apriltrack
