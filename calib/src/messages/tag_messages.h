#pragma once

#include <string>

#include "apriltrack/calib/calibration_finding.h"
#include "model/tag_finding.h"
#include "observations/observations.h"

namespace apriltrack {

/// What is wrong with the tag, by how much, which others may be at fault instead, and what to do.
std::string message_of(const Observations& observations, const TagFinding& finding);

/// The same as a user gets it.
CalibrationFinding reported(const Observations& observations, const TagFinding& finding);

/// "0.09 m and 3.0 degrees".
std::string shift_and_turn(const Pose& change);

}  // namespace apriltrack
