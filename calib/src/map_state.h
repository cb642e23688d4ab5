#pragma once

#include <vector>

#include "parts.h"
#include "view_candidates.h"

namespace apriltrack {

/// The unknowns of a calibration, indexed like Observations::tags and ::frames; entries that a part does not
/// use stay at identity.
struct MapState {
  std::vector<Pose> T_map_tag;
  std::vector<Pose> T_map_rig;
};

/// A first map, free of flips as far as the views allow: tags along the tree of best-supported links from
/// `held_tag` (which lies at the origin), frames by the candidate that explains all their tags best, then
/// tags and frames in turn by their candidates' reprojection errors.
MapState start_state(const Observations& observations, const Part& part, int held_tag,
                     const std::vector<ViewCandidates>& candidates, const ParallelFor& parallel);

/// Sum over the corners of log(1 + (error / 4 px)^2): grows for every error, but no view can outvote the
/// others.
double robust_error(const Observations& observations, const TagView& view, const Pose& T_map_rig,
                    const Pose& T_map_tag);

/// Expresses everything in the frame of `tag`.
void move_origin_to(MapState& state, int tag);

}  // namespace apriltrack
