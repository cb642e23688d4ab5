#pragma once

#include "apriltrack/calib/calibration_options.h"
#include "apriltrack/calib/map_evidence.h"
#include "solution/part_solution.h"

namespace apriltrack {

/// What the map of `solution` rests on, in the numbers of its map (to which part.tags give the order).
MapEvidence part_evidence(const Observations& observations, const PartSolution& solution,
                          const CalibrationOptions& options);

}  // namespace apriltrack
