#pragma once

#include "initialise/part_adjustment.h"

namespace apriltrack {

/// Throws Error(kNoResult) where cameras of a rig sit far from where its file has them: lengths in
/// millimetres, the inverse, or another rig's. So gross an error makes sound tags look loose or moved, before
/// any adjustment could tell whose it is. What a lens that is a few percent off would do is no such error,
/// nor, where places are to be refined, three times as much. Cameras that never see tags at one time are not
/// judged.
void require_rig_that_fits(const PartTask& task, const Part& part);

}  // namespace apriltrack
