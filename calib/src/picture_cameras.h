#pragma once

#include <optional>
#include <vector>

#include "apriltrack/calib/calibrate_map.h"
#include "error_scale.h"
#include "photometric_adjustment.h"
#include "tag_covariance.h"

namespace apriltrack {

/// What a map made of pictures owes to cameras that were estimated from corners before: the pictures take
/// them as they are, and all poses follow their errors. nullopt where none were estimated. views: of the
/// scene's pictures, linearised at `state`; poses: of these views.
std::optional<SharedErrors> errors_of_cameras(const CalibrationResult& calibration,
                                              const PhotometricScene& scene, const PhotometricState& state,
                                              const std::vector<LinearView>& views,
                                              const PoseInformation& poses, const ErrorScale& scale);

}  // namespace apriltrack
