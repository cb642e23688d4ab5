#pragma once

#include "apriltrack/base/parallel.h"
#include "model/map_state.h"
#include "model/solve_context.h"

namespace apriltrack {

/// Frames may have been mirrored about a tag that agrees with either pose; where tags are small, no view
/// looks far off by it, and the tags give way. Tries each in the poses that its tags propose one by one, the
/// tags as they are, and keeps what explains its views better. False when no frame was turned; else the
/// caller adjusts again.
bool turn_mirrored_frames(const PartTask& task, const Part& part, MapState& state,
                          const ParallelFor& parallel);

}  // namespace apriltrack
