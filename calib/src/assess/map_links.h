#pragma once

#include <vector>

#include "apriltrack/calib/joint_covariance.h"
#include "apriltrack/calib/map_assessment.h"
#include "apriltrack/calib/map_evidence.h"
#include "apriltrack/camera/camera.h"
#include "apriltrack/tags/tag_map.h"

namespace apriltrack {

/// Tags of each moment, as sorted sets of places in the map.
std::vector<std::vector<int>> tags_by_moment(const MapEvidence& evidence);

/// Moments in which each two tags are seen together, sorted.
std::vector<SeenTogether> links_of(const std::vector<std::vector<int>>& moments);

/// Of each edge of the tree of most moments: the two sides, and how many moments tie them. Where a part whose
/// tags hang together well is tied to the rest by few moments, one edge of that tree leads there.
std::vector<HangingPart> hanging_parts(const TagMap& map, const std::vector<std::vector<int>>& moments,
                                       std::vector<SeenTogether>& links);

}  // namespace apriltrack
