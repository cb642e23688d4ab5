#pragma once

#include <vector>

#include "apriltrack/calib/calibration_finding.h"
#include "faults/lost_links.h"
#include "faults/rejected_stands.h"
#include "faults/split_links.h"

namespace apriltrack {

// Views that disagree with the map, as a user gets them.

CalibrationFinding reported(const Observations& observations, const LostLink& link);
CalibrationFinding reported(const Observations& observations, const SplitLink& link);
CalibrationFinding reported(const Observations& observations, const RejectedStand& stand);

}  // namespace apriltrack
