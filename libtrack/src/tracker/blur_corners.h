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
  /// Indices (of the map) of those that lie where it says, within what their noise allows.
  std::vector<int> agreeing;
  /// Of those that do not. Those read with a corrected bit or seen twice are left out: they may be false.
  std::vector<int> contradicting;
};
/// The evidence by which a state is judged: that of the tags that agree, if any does; else of all.
std::vector<TagEvidence> quorum(const std::vector<TagEvidence>& tags, const TagVotes& votes);

TagVotes count_votes(const PhotometricWorld& world, const std::vector<TagObservation>& observations,
                     const MotionState& state, double exposure_s, double sharp_sigma_px);

/// Takes the correlation of those tags that `state` shows where another tag of about their size was read,
/// without a corrected bit: blurred, neighbours look much alike, and some are in no map. Those that agree are
/// spared, and so are tags under another that agrees: a small tag may lie upon a large one.
void discredit_tags_read_as_others(const PhotometricWorld& world, const std::vector<Detection>& detections,
                                   const MotionState& state, const TagVotes& votes,
                                   std::vector<TagEvidence>& tags);

}  // namespace apriltrack
