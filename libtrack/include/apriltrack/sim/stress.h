#pragma once

#include <cstdint>

#include "apriltrack/sim/scene.h"

namespace apriltrack {

/// What makes a scene harder to track, on top of what the scene is.

/// A hand comes up from below before the lens, to and fro sideways, so wide that it hides `share_of_width` of
/// the image's width; its fingertips reach into the upper quarter. In front of everything: 0.25 m from the
/// camera.
void add_passing_hand(Scene& scene, double share_of_width);

/// Another take of the same: phases of all waves faster than 0.3 Hz and of all bursts, and the bursts' times
/// by up to 0.3 s, are drawn from `take`, of the camera and of every body. Amplitudes, frequencies and slow
/// waves stay, and so does a path that closes.
void vary_motion(Scene& scene, std::uint64_t take);

}  // namespace apriltrack
