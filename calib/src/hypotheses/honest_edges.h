#pragma once

#include "model/adjusted_part.h"
#include "model/solve_context.h"

namespace apriltrack {

/// Asks where edges lie, by those that were seen and by those of the map (take_edges_from_map): the pull of
/// the corners' own errors is less by these. Where that makes a difference the views keep the latter, and
/// `solved` is adjusted by them. part: before outliers were removed. observations: the task's.
void take_honest_edges(const PartTask& task, const Part& part, Observations& observations,
                       AdjustedPart& solved);

}  // namespace apriltrack
