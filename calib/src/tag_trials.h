#pragma once

#include <vector>

#include "tag_fault.h"

namespace apriltrack {

/// Whether a fault explains all that frames say of the tag, and most of them show two others that agree: no
/// other can be to blame.
bool is_explained_beyond_doubt(const PartTask& task, const Part& part, const AdjustedPart& solved, int tag);

/// Faults that tear frames apart: where a frame shows the faulty tag and one other, the fit gives up both,
/// and either seems at fault. Each tag of which views were given up, or that is not in the map, is held
/// responsible in turn (but those that frames of three tags explain), and the map solved anew: with the tag moved while filming, or of another size. Found
/// is what explains most of what was given up; two tags where either would do. part: before outliers were
/// removed.
std::vector<TagFinding> find_faults_by_trial(const PartTask& task, const Part& part,
                                             const AdjustedPart& solved, const ParallelFor& parallel);

}  // namespace apriltrack
