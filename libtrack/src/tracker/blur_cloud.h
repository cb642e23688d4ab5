#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "apriltrack/motion/motion_state.h"
#include "apriltrack/photometric/evidence.h"

namespace apriltrack {

struct CloudOptions {
  int num_particles = 240;  ///< About all beliefs together.
  std::uint64_t seed = 0;
  std::uint64_t index = 0;  ///< Of this search among those of the recording: the key of its numbers.
};

struct CloudState {
  MotionState state;
  std::size_t belief = 0;  ///< Of those given, the one that the state was found about.
};

/// States worth a fit, best first, at most six, apart from each other: the survivors of a search around
/// `beliefs`, at least one, that starts with the tags' pictures heavily blurred and sharpens them round by
/// round (the cross-entropy method: Rubinstein 1999; docs/algorithms/blur_tracker.md, section 5).
///
/// The first round looks at `seeds` too. The same options give the same states, always.
std::vector<CloudState> search_cloud(PhotometricWorld& world, const PhotometricFrame& frame,
                                     const std::vector<MotionBelief>& beliefs,
                                     const std::vector<MotionState>& seeds, const CloudOptions& options);

}  // namespace apriltrack
