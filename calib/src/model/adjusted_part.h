#pragma once

#include <set>
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
  std::vector<int> undecided = {};  ///< Left out, for the views leave them two poses.
  std::vector<TagFinding> findings = {};
};

/// As undecided, or for a fault.
std::set<int> tags_left_out(const AdjustedPart& solved);

}  // namespace apriltrack
