#pragma once

#include <vector>

#include "apriltrack/base/parallel.h"
#include "hypotheses/better_cameras.h"
#include "model/tag_finding.h"

namespace apriltrack {

/// A part by the cameras that agree best with it, without the tags that cannot be trusted.
struct ImprovedPart {
  AdjustedPart solved;
  BetterCameras cameras;
  std::vector<int> contradicted;  ///< Left out, for most of their views were rejected.
};

/// Cameras first, then tags that are faulty by these, and cameras again where any had to go.
/// known: the cameras, where another part told them already. observations: the task's; in the end the
/// edges of its views are those of the map where that moves an edge offset (take_edges_from_map); where this
/// throws, they may be of a map that was not taken.
ImprovedPart improve_part(const PartTask& task, const Part& part, AdjustedPart solved,
                          const BetterCameras* known, Observations& observations,
                          const ParallelFor& parallel);

}  // namespace apriltrack
