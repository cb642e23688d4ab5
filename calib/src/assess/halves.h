#pragma once

#include "apriltrack/calib/calibration_options.h"
#include "apriltrack/calib/cross_validation.h"
#include "solution/part_solution.h"

namespace apriltrack {

/// Solves the part from each half of its moments, blocks by turns, from where the solution of all is, with
/// its views, cameras and noise; and holds the two maps against each other
/// (docs/algorithms/calibration.md, section 9).
CrossValidation cross_validate(const Observations& observations, const PartSolution& solution,
                               const CalibrationOptions& options);

}  // namespace apriltrack
