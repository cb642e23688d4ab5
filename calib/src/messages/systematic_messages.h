#pragma once

#include "apriltrack/calib/calibration_finding.h"
#include "apriltrack/calib/systematic_errors.h"

namespace apriltrack {

// Errors that many views share, as a user gets them.

CalibrationFinding reported(const TimeError& error);
CalibrationFinding reported(const PrintBatches& batches);
/// print_aspect: by how much tags may be printed wider than high.
CalibrationFinding reported_print_aspect(double print_aspect);

}  // namespace apriltrack
