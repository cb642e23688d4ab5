#pragma once

#include <vector>

#include "apriltrack/base/parallel.h"
#include "apriltrack/calib/calibration_options.h"
#include "apriltrack/calib/map_constraints.h"
#include "apriltrack/calib/systematic_errors.h"
#include "model/solve_context.h"
#include "solution/part_solution.h"

namespace apriltrack {

/// What a part is solved by.
struct CamerasOfPart {
  const std::vector<RigCamera>& start;  ///< To begin with; `observations.cameras` is what is known of them.
  const std::vector<ViewCandidates>& candidates;  ///< Of all views, by these.
  /// What another part says of `start`: no part has cameras of its own. None: to be estimated.
  const BetterCameras* known = nullptr;
  std::vector<TimeError> time_errors = {};  ///< That it says of them.
};

/// Start, robust adjustment, outliers removed, clean adjustment, mirrored tags turned, covariances; all of it
/// again without the tag that makes frames contradict each other, if there is one, or those of which any may.
/// Throws Error(kNoResult) when it does not converge, converges to nonsense, or contradictions stay, of views
/// or of constraints. observations: in the end the edges of its views are those of the map where that moves
/// an edge offset (take_edges_from_map). constraints: whose tags are named by family and id.
PartSolution solve_part(Observations& observations, const CamerasOfPart& cameras, const Part& part,
                        int held_tag, const CalibrationOptions& options,
                        const std::vector<MapConstraint>& constraints, const ParallelFor& parallel);

}  // namespace apriltrack
