#pragma once

#include <vector>

#include "map_state.h"

namespace apriltrack {

/// The other minimum of the planar ambiguity: the tag reflected about the plane across the line of sight, as
/// seen from afar. direction: from the viewer to the tag, any length, in the frame of `T_frame_tag`.
Pose mirrored_about(const Pose& T_frame_tag, const Eigen::Vector3d& direction);

/// Tries every tag in its mirrored pose, with its frames free to follow, and keeps what explains the views
/// clearly better. Returns the tags that were turned; the caller adjusts again if there are any. The held tag
/// may turn, too: the map is then moved back to it.
std::vector<int> turn_mirrored_tags(const Observations& observations, const Part& part, int held_tag,
                                    MapState& state);

}  // namespace apriltrack
