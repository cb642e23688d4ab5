#pragma once

#include <cstddef>
#include <vector>

#include "observations/observations.h"
#include "observations/parts.h"

namespace apriltrack {

/// Tags that were elsewhere while the camera stood still.
struct RejectedStand {
  std::vector<int> tags;  ///< One, or several of which any may be elsewhere; sorted.
  int num_frames = 0;     ///< Of one place.
  Timestamp first;
};

/// As counted by places such a tag is a few rejected views, or one. rejected: views of such places that the
/// map, which rests on `kept`, does not fit. What was rejected beside views that fit is where the map does
/// not have it; else either of those that the frame shows may be, and frames of one tag say nothing. Stands
/// of fewer than five frames may be chance.
std::vector<RejectedStand> find_rejected_stands(const Observations& observations, const Part& kept,
                                                const std::vector<std::size_t>& rejected);

}  // namespace apriltrack
