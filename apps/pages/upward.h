#pragma once

#include <Eigen/Core>

#include "apriltrack/calib/map_evidence.h"
#include "apriltrack/tags/tag_map.h"

namespace apriltrack::app {

/// Up is up as the camera was held, as far as it tells: a map knows of no gravity.
Eigen::Vector3d upward(const TagMap& map, const MapEvidence& evidence);

}  // namespace apriltrack::app
