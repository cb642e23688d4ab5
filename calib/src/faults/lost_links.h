#pragma once

#include <vector>

#include "observations/observations.h"
#include "observations/parts.h"

namespace apriltrack {

/// Two tags of the map that some frames show together, none of which fits.
struct LostLink {
  int tag_a = 0, tag_b = 0;
  int num_frames = 0;       ///< That show both.
  std::vector<int> joints;  ///< Each of these, or its board, alone joins the two in the map. Not empty.
};

/// Links by which the map may be folded: if their frames are right, one of the joints hangs twice or was
/// moved, and nothing else can show it. offered: the views before outliers were removed; kept: those that the
/// map rests on.
std::vector<LostLink> find_lost_links(const Observations& observations, const Part& offered,
                                      const Part& kept);

}  // namespace apriltrack
