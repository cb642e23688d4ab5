#pragma once

#include <vector>

#include "apriltrack/calib/calibration_finding.h"
#include "apriltrack/calib/calibration_options.h"
#include "apriltrack/calib/systematic_errors.h"
#include "hypotheses/better_cameras.h"
#include "initialise/starting_cameras.h"

namespace apriltrack {

/// What of the cameras is not as it should be and was not taken, or is open: by which the map may be wrong.
std::vector<CalibrationFinding> doubts_of_cameras(const Observations& observations,
                                                  const BetterCameras& cameras);

/// That the map rests on other numbers than the camera file's.
CalibrationFinding reported(const CameraRefinement& cameras,
                            const std::vector<CameraCorrection>& corrections);

/// A camera file's lens by which tags do not look square, and which is kept all the same.
CalibrationFinding reported(const Observations& observations, const LensDoubt& doubt,
                            const CalibrationOptions& options);
/// "by the lens that the camera file has of cam0, the tags do not look square".
std::string message_of(const Observations& observations, const LensDoubt& doubt);

/// Where edge offsets are larger than expected: views of small tags, far off and from the front, may be
/// explained as well by edges that lie aside as by tags that lie nearer, and the scale follows.
std::vector<CalibrationFinding> unusual_edges(const std::vector<CameraCorrection>& corrections,
                                              const CalibrationOptions& options);

}  // namespace apriltrack
