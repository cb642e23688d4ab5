#pragma once

#include <optional>
#include <vector>

#include "apriltrack/base/log.h"
#include "apriltrack/base/parallel.h"
#include "initialise/part_adjustment.h"

namespace apriltrack {

/// Tags whose absence might explain the contradictions: any of a small map, for an id that hangs in two
/// places folds the map, and frames far from both are rejected; of a large one those that are
/// accused, most often first.
std::vector<int> culprit_candidates(const Part& part, const Contradictions& contradictions);

/// The part without the one tag whose absence leaves no contradictions: of several the one whose fault can be
/// named then. Where several have faults that explain about as much, or none has a name, without all of
/// those: any may be wrong, and the map with it. nullopt when no tag is the cause.
/// contradictions: of the part with all its tags; none where it could not even be adjusted.
std::optional<AdjustedPart> adjust_without_culprit(const PartTask& task, const Part& part,
                                                   const Contradictions& contradictions, int held_tag,
                                                   const ParallelFor& parallel, const LogSink& log);

/// Names the most contradicted tags.
NoMap contradictory(const Observations& observations, const Contradictions& contradictions);

}  // namespace apriltrack
