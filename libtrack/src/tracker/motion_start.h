#pragma once

#include <optional>

#include "apriltrack/motion/motion_state.h"
#include "apriltrack/photometric/photometric_world.h"
#include "pose_candidate.h"

namespace apriltrack {

/// What a detection alone says of the motion: about where, and nothing of the velocity but that it is usual.
/// nullopt where the corners do not hold the pose.
std::optional<MotionBelief> cold_belief(const PhotometricWorld& world, const PoseCandidate& candidate);

/// The velocity that the belief expects where the pose is known; nullopt when the pose is beyond belief: six
/// standard deviations.
std::optional<MotionState> conditioned(const MotionBelief& belief, const Pose& pose);

/// The tag tilted the other way about its centre: from far off it looks the same. As seen along the line of
/// sight, D R D with D = diag(1, 1, -1) has the same upper left block, and so the same scaled orthographic
/// picture (Oberkampf, DeMenthon, Davis, "Iterative pose estimation using coplanar feature points", 1996).
Pose mirrored_tilt(const Pose& T_camera_tag);
/// The same of a state, by the tag: its centre moves as before, and the tag turns about the line of sight as
/// before and about the others the other way.
MotionState mirrored_state(const MotionState& state, const Pose& T_map_tag, TrackMode mode);

}  // namespace apriltrack
