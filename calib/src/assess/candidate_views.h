#pragma once

#include <vector>

#include "apriltrack/calib/joint_covariance.h"
#include "apriltrack/calib/map_assessment.h"
#include "apriltrack/calib/map_evidence.h"
#include "apriltrack/camera/camera.h"
#include "apriltrack/tags/tag_map.h"

namespace apriltrack {

/// A place for the camera, chosen before a tag to show another one with it.
struct CandidateView {
  int tag = 0, partner = 0;                 ///< Into TagMap::tags.
  double distance_m = 0.0;                  ///< From the tag.
  double aside_rad = 0.0, above_rad = 0.0;  ///< As ViewAdvice has them.
  Pose T_map_camera;
};

/// Where a picture of `tag` might be taken from: about where the camera has been, a hand's walk farther at
/// most, upright as the tag hangs, and looking between the tag and one of its nearest. is_dense: from more
/// sides, with more partners.
std::vector<CandidateView> candidate_views(const TagMap& map, const MapEvidence& evidence,
                                           const Camera& camera, int tag, bool is_dense);

}  // namespace apriltrack
