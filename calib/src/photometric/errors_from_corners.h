#pragma once

#include <optional>
#include <vector>

#include "apriltrack/calib/calibration_result.h"
#include "photometric/photometric_adjustment.h"
#include "uncertainty/error_scale.h"
#include "uncertainty/tag_covariance.h"

namespace apriltrack {

/// What a map made of pictures owes to what corners told before, and pictures take as it is: cameras that
/// were estimated or left open, and prints that may not be as stated. All poses follow these errors. nullopt
/// where there are none. keys: of the scene's tags; views: of its pictures, linearised at `state`; poses: of
/// these views.
std::optional<SharedErrors> errors_from_corners(const CalibrationResult& calibration,
                                                const PhotometricScene& scene,
                                                const std::vector<TagKey>& keys,
                                                const PhotometricState& state,
                                                const std::vector<LinearView>& views,
                                                const PoseInformation& poses, const ErrorScale& scale);

}  // namespace apriltrack
