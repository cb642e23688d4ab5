#pragma once

#include "part_adjustment.h"

namespace apriltrack {

/// Throws Error(kNoResult) where the cameras of a rig sit far from where its file has them: lengths in
/// millimetres, the inverse, or another rig's. So gross an error makes sound tags look loose or moved, before
/// any adjustment could tell whose it is. Cameras that never see tags at one time are not judged.
void require_rig_that_fits(const PartTask& task, const Part& part, int held_tag, const ParallelFor& parallel);

}  // namespace apriltrack
