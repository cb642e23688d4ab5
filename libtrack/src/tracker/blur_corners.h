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

/// What the tags detected say of a state.
struct TagVotes {
  int agreeing = 0;  ///< They lie where it says, within what their noise allows.
  /// They do not. Those read with a corrected bit or seen twice are not counted: they may be false.
  int contradicting = 0;
};
TagVotes count_votes(const PhotometricWorld& world, const std::vector<TagObservation>& observations,
                     const MotionState& state, double exposure_s, double sharp_sigma_px);

/// Takes the correlation of those tags that `state` shows where another tag was read, without a corrected
/// bit: blurred, neighbours look much alike, and some are in no map.
void discredit_tags_read_as_others(const PhotometricWorld& world, const std::vector<Detection>& detections,
                                   const MotionState& state, std::vector<TagEvidence>& tags);

}  // namespace apriltrack
