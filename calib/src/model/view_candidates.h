#pragma once

#include <vector>

#include "apriltrack/base/parallel.h"
#include "observations/observations.h"

namespace apriltrack {

/// Where a view's tag may be: both minima of the planar ambiguity, for others to choose from.
struct ViewCandidates {
  struct Candidate {
    Pose T_rig_tag;
    double weight = 0.0;  ///< In (0, 1]: 1 for the smaller reprojection error.
  };
  std::vector<Candidate> candidates;  ///< None, one or two.
};

/// One entry for each of observations.views; empty for views that are not in `views`.
std::vector<ViewCandidates> solve_views(const Observations& observations,
                                        const std::vector<std::size_t>& views, const ParallelFor& parallel);

}  // namespace apriltrack
