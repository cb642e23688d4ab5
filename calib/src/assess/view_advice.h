#pragma once

#include <vector>

#include "apriltrack/calib/joint_covariance.h"
#include "apriltrack/calib/map_assessment.h"
#include "apriltrack/calib/map_evidence.h"
#include "apriltrack/camera/camera.h"
#include "apriltrack/tags/tag_map.h"

namespace apriltrack {

/// Pictures for the tags that are known least relative to the gauge, one after the other: each on top of
/// those before. None for tags that are known well, or that no picture helps much. Requires a joint
/// covariance.
std::vector<ViewAdvice> advise_views(const TagMap& map, const JointCovariance& joint,
                                     const MapEvidence& evidence, const CameraRig& rig);

}  // namespace apriltrack
