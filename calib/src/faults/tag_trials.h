#pragma once

#include <vector>

#include "apriltrack/base/parallel.h"
#include "faults/tag_fault.h"

namespace apriltrack {

/// Whether what is wrong with the tag needs no trial: frames that show two others which agree tell of the
/// views that were given up, or of a shape, which the tag has in all of its views.
bool do_frames_tell(const PartTask& task, const Part& part, const AdjustedPart& solved, int tag);

/// Faults that tear frames apart: where a frame shows the faulty tag and one other, the fit gives up both,
/// and either seems at fault. Each tag of which views were given up, or that is not in the map, is held
/// responsible in turn (but those of which frames of three tags tell), and the map solved anew: with the tag
/// moved while filming, or of another size. Found is what explains most of what was given up, several tags
/// where any would do; then what explains the next most. part: before outliers were removed.
std::vector<std::vector<TagFinding>> find_faults_by_trial(const PartTask& task, const Part& part,
                                                          const AdjustedPart& solved,
                                                          const ParallelFor& parallel);

/// Of a tag that seems loose by the single frames, some of which may be mirrored: that it moved once, or
/// hangs twice, where that explains its views after all; else as it was found. solved: the map without it.
TagFinding places_or_loose(const PartTask& task, const Part& part, const AdjustedPart& solved,
                           TagFinding loose);

}  // namespace apriltrack
