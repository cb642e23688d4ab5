#pragma once

#include <optional>
#include <vector>

#include "apriltrack/base/parallel.h"
#include "model/adjusted_part.h"
#include "model/outcome.h"
#include "model/solve_context.h"
#include "solve/camera_parameters.h"

namespace apriltrack {

/// The part, adjusted; where it cannot be, without the one tag that keeps it from that.
Outcome<AdjustedPart> adjust_part_or_most_of_it(const PartTask& task, const Part& part, int held_tag,
                                                const ParallelFor& parallel);

/// Asks of every tag whether the views are likelier by a fault of it than without. Takes the worst out of the
/// map, adjusts the rest anew and asks again, for what a faulty tag does to its neighbours goes with it.
/// Where several tags may be why, the map is adjusted without each, and the one is taken out without which
/// the others' views agree best; all of them, where the views do not tell. Where frames contradict each other
/// the map may be folded, and tags that such frames show are asked, too.
///
/// Ends where no fault is likely, or where it is likelier that other `cameras` are why. Each fault is added
/// to AdjustedPart::findings; tags that are bent stay in the map. part: before outliers were removed. Throws
/// HeldTagAtFault, and NothingLeft where too little is left.
void leave_out_faulty_tags(const PartTask& task, const Part& part, const CameraParameters& cameras,
                           AdjustedPart& solved, const ParallelFor& parallel);

/// Names the most contradicted tags.
NoMap contradictory(const Observations& observations, const Contradictions& contradictions);

}  // namespace apriltrack
