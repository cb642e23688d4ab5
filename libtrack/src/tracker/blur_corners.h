#pragma once

#include <vector>

#include "apriltrack/photometric/motion_fit.h"
#include "tag_observation.h"

namespace apriltrack {

/// The corners of the tags detected without a corrected bit, with the noise to expect where they move as
/// `state` says.
std::vector<CornerObservation> corner_observations(const PhotometricWorld& world,
                                                   const std::vector<TagObservation>& observations,
                                                   const MotionState& state, double exposure_s,
                                                   double sharp_sigma_px);

/// How many detected tags lie where `state` says, within what their noise allows.
int count_agreeing_tags(const PhotometricWorld& world, const std::vector<TagObservation>& observations,
                        const MotionState& state, double exposure_s, double sharp_sigma_px);

}  // namespace apriltrack
