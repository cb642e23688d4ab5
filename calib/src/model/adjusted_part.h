#pragma once

#include <vector>

#include "model/contradictions.h"
#include "model/map_state.h"
#include "model/tag_finding.h"

namespace apriltrack {

/// An adjusted part, and how it agrees with its frames.
struct AdjustedPart {
  int held_tag = 0;
  Part part;  ///< What was kept: outliers, and tags that hung on them alone, are gone.
  MapState state;
  Contradictions contradictions;
  std::vector<int> culprits = {};   ///< Left out, for the frames contradict each other with them.
  std::vector<int> undecided = {};  ///< Left out, for the views leave them two poses.
  /// Of culprits: one of these is so, and the views do not tell which.
  std::vector<TagFinding> rivals = {};
};

}  // namespace apriltrack
