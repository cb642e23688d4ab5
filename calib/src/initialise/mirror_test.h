#pragma once

#include <vector>

#include "apriltrack/base/parallel.h"
#include "model/map_state.h"
#include "model/solve_context.h"

namespace apriltrack {

/// Tries every tag, and every group of tags that hangs on one link, in the poses that a mirrored tag at the
/// hinge would give it, and (where it is in doubt) that single frames there propose, with the frames free to
/// follow, and keeps what explains the views better. False when nothing was turned; else the caller adjusts
/// again. The held tag may turn, too: the map is then moved back to it.
bool turn_mirrored_groups(const PartTask& task, const Part& part, int held_tag, MapState& state,
                          const ParallelFor& parallel);

/// Groups that the views leave a second pose, about as likely as the one they have: smallest first, each
/// sorted.
std::vector<std::vector<int>> undecided_groups(const PartTask& task, const Part& part, const MapState& state,
                                               const ParallelFor& parallel);

}  // namespace apriltrack
