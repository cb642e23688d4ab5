#pragma once

#include "constraints/constrained_fit.h"

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

/// Where the tags of a group lie to each other.
struct CentresOfTags {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Vector3d line, normal;  ///< The longest axis of the centres, and the shortest.
  bool are_in_line = false;      ///< So that their normals alone can tell the plane.
};
CentresOfTags centres_of(std::span<const int> tags, const std::vector<Pose>& T_held_tag);

/// The plane of a coplanar group: through the centres, tags before it; of a row of tags by their normals.
Pose plane_start(const BoundConstraint& group, const std::vector<Pose>& T_held_tag);

}  // namespace apriltrack
