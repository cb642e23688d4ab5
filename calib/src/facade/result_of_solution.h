#pragma once

#include <string>

#include "apriltrack/calib/calibration_options.h"
#include "apriltrack/calib/calibration_result.h"
#include "apriltrack/camera/camera.h"
#include "apriltrack/tags/tag_map.h"
#include "facade/part_solver.h"
#include "messages/calibration_messages.h"

namespace apriltrack {

/// The tags of a part, with covariances and flags.
TagMap to_map(const Observations& observations, const PartSolution& solution, const std::string& frame);

/// The cameras as the part was solved with them, and what was corrected. rig: as it was given.
void take_cameras(const Observations& observations, const CameraRig& rig, const PartSolution& solution,
                  const CalibrationOptions& options, CalibrationResult& result, Findings& findings);

/// The map, what constraints made of it, how well it was seen, and where from. After take_cameras.
void take_map(const Observations& observations, const PartSolution& solution,
              const CalibrationOptions& options, CalibrationResult& result, Findings& findings);

}  // namespace apriltrack
