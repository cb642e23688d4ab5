#pragma once

#include "motion_objective.h"

namespace apriltrack {

/// Levenberg and Marquardt's steps of a state, on the pixels that the objective has chosen.
///
/// Ends where the step ahead is negligible, will be as steps shrink, or leads nowhere; true then, false after
/// max_steps. current: evaluated; the best state found. spare: memory.
bool descend(const MotionObjective& objective, int max_steps, EvaluatedState& current, EvaluatedState& spare);

}  // namespace apriltrack
