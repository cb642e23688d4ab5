#pragma once

#include <cstdint>
#include <vector>

#include "apriltrack/motion/motion_state.h"
#include "apriltrack/photometric/evidence.h"

namespace apriltrack {

struct CloudOptions {
  int num_particles = 240;  ///< In each round.
  std::uint64_t seed = 0;
  std::uint64_t index = 0;  ///< Of this search among those of the recording: the key of its numbers.
};

/// States worth a fit, best first, at most six, apart from each other: the survivors of a search around
/// `belief` that starts with the tags' pictures heavily blurred and sharpens them round by round (the
/// cross-entropy method: Rubinstein 1999; docs/algorithms/blur_tracker.md, section 5).
///
/// The first round looks at `seeds` too. The same options give the same states, always.
std::vector<MotionState> search_cloud(PhotometricWorld& world, const PhotometricFrame& frame,
                                      const MotionBelief& belief, const std::vector<MotionState>& seeds,
                                      const CloudOptions& options);

}  // namespace apriltrack
