#pragma once

#include <string>

#include "apriltrack/calib/joint_covariance.h"
#include "apriltrack/calib/map_assessment.h"
#include "apriltrack/calib/map_evidence.h"
#include "apriltrack/camera/camera.h"
#include "apriltrack/tags/tag_map.h"

namespace apriltrack {

/// From where a tag was seen, as far as it explains what the views leave open: "3 frames, all head-on (within
/// 8 degrees of its normal), all from 3.9 to 4.1 m; seen together with tag36h11/5 in 2 frames". tag: into the
/// map. neighbour: the tag that it is known by; frames_together: moments that show both.
std::string summary_of_views(const MapEvidence& evidence, int tag, const std::string& neighbour,
                             int frames_together);

}  // namespace apriltrack
