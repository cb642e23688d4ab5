#pragma once

#include <set>
#include <vector>

#include "model/tag_finding.h"
#include "observations/observations.h"
#include "observations/parts.h"
#include "observations/tag_paths.h"

namespace apriltrack {

/// Tags, or boards of them (TagPaths::board_of), each of which lies on every way from some tags to others,
/// ends included, over frames that show two of them. Empty where there
/// is no way, and where none lies on all; none includes another.
std::vector<std::set<int>> joints_between(const TagPaths& paths, const std::set<int>& from,
                                          const std::set<int>& to);

/// Of a tag that was found at two places: the others, or boards of them, each of which alone joins what was
/// seen beside it at the one place with what was seen beside it at the other. Had such a one changed its
/// place instead, no view would differ. Empty where there are not two places. part: all views; ties: those
/// that hold the map together, the found tag's not asked.
std::vector<std::set<int>> rival_tags(const Observations& observations, const Part& part, const Part& ties,
                                      const TagFinding& finding);

}  // namespace apriltrack
