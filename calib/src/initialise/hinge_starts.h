#pragma once

#include <vector>

#include "initialise/hinge.h"
#include "model/view_candidates.h"
#include "solve/group_motion.h"

namespace apriltrack {

/// The other minimum of the planar ambiguity: the tag reflected about the plane across the line of sight, as
/// seen from afar. direction: from the viewer to the tag, any length, in the frame of `T_frame_tag`.
Pose mirrored_about(const Pose& T_frame_tag, const Eigen::Vector3d& direction);

/// Where the group would lie if a tag at the hinge were seen mirrored: its own one, the frames as they are;
/// or one of the others, and the frames are where the group has them.
std::vector<GroupMotion> mirrored_starts(const Observations& observations, const MapState& state,
                                         const Hinge& hinge);

/// Where single frames have the group, by what they propose of a tag of it and of another one, or where it
/// would lie if both were seen mirrored, as a scene that is nearly flat looks the same from afar when it is
/// turned inside out: the likeliest that differ from each other and from where it lies. One tag mirrored may
/// have bent the map so that no tag's mirrored pose agrees with it.
std::vector<GroupMotion> proposed_starts(const Observations& observations,
                                         const std::vector<ViewCandidates>& candidates, const MapState& state,
                                         const Hinge& hinge);

}  // namespace apriltrack
