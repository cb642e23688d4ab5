#pragma once

#include "apriltrack/geometry/pose.h"

namespace apriltrack {

/// How squarely a tag is seen: the cosine of the angle between its normal, which points INTO it, and the line
/// of sight to its centre. 1 for a tag seen head-on, above 0 where it shows its face, below from behind.
inline double tag_view_cosine(const Pose& T_camera_tag) {
  const Eigen::Vector3d into_tag = T_camera_tag.rotation() * Eigen::Vector3d::UnitZ();
  return into_tag.dot(T_camera_tag.translation().normalized());
}

}  // namespace apriltrack
