#pragma once

#include "constrained_fit.h"

namespace apriltrack {

/// Where the map's frame lies, as a start.
struct MapFrameStart {
  Pose T_map_held;
  bool is_ambiguous = false;  ///< Another frame, turned by more than a few degrees, fits about as well.
};

/// The frame that most constraints agree with, the tags where the images have them: robust steps from each of
/// the 24 orientations of a cube, the least turned first. What the constraints leave open stays as with the
/// held tag at the origin.
MapFrameStart find_map_frame(std::span<const BoundConstraint> constraints, const ConstraintPrior& prior);

/// The plane of a coplanar group: mean centre, mean normal.
Pose plane_start(const BoundConstraint& group, const std::vector<Pose>& T_held_tag);

}  // namespace apriltrack
