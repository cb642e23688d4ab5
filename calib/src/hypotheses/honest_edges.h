#pragma once

#include <functional>

#include "hypotheses/better_cameras.h"

namespace apriltrack {

/// Takes better cameras into what was solved, and into what is known of cameras.
using Improvement = std::function<void(const PartTask&, AdjustedPart&, BetterCameras&)>;

/// Improves them, and where edges are then found aside, asks whether that is the pull of the corners' own
/// errors: by the edges of the map (take_edges_from_map) it may be less. The views keep those where it
/// matters. observations: the task's.
void improve_honestly(const PartTask& task, const Part& part, const Improvement& improve,
                      Observations& observations, AdjustedPart& solved, BetterCameras& cameras);

}  // namespace apriltrack
