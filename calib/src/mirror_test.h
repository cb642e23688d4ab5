#pragma once

#include <vector>

#include "apriltrack/base/parallel.h"
#include "map_state.h"

namespace apriltrack {

/// The other minimum of the planar ambiguity: the tag reflected about the plane across the line of sight, as
/// seen from afar. direction: from the viewer to the tag, any length, in the frame of `T_frame_tag`.
Pose mirrored_about(const Pose& T_frame_tag, const Eigen::Vector3d& direction);

/// Tries every tag, and every group of tags that hangs on one link, in the poses that a mirrored tag at the
/// hinge would give it, with the frames there free to follow, and keeps what explains the views better. False
/// when nothing was turned; else the caller adjusts again. The held tag may turn, too: the map is then moved
/// back to it.
bool turn_mirrored_groups(const Observations& observations, const Part& part, int held_tag, MapState& state,
                          const ParallelFor& parallel);

/// Groups that the views leave a second pose, about as likely as the one they have: smallest first, each
/// sorted.
std::vector<std::vector<int>> undecided_groups(const Observations& observations, const Part& part,
                                               const MapState& state, const ParallelFor& parallel);

}  // namespace apriltrack
