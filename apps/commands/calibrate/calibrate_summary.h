#pragma once

#include <optional>

#include "calibrate_output.h"

namespace apriltrack::app {

/// The answer on stdout. refinement: none where it was not asked for.
void tell_calibration(const CalibrateOptions& options, const Sightings& sightings,
                      const ResponseFindings& responses, const CalibrationResult& result,
                      const std::optional<RefinementResult>& refinement, const CalibrationFindings& findings,
                      const CalibrationFiles& files);

}  // namespace apriltrack::app
