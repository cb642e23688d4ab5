#pragma once

#include <set>
#include <vector>

#include "observations.h"
#include "parts.h"
#include "tag_finding.h"

namespace apriltrack {

/// The tags each of which lies on every way from some tags to others, ends included, over frames that show
/// two of them. ties: the views that make these ways. Empty where there is no way, and where no one tag lies
/// on all.
std::vector<int> joints_between(const Observations& observations, const Part& ties, const std::set<int>& from,
                                const std::set<int>& to);

/// Of a tag that was found at two places: the others each of which alone joins what was seen beside it at the
/// one place with what was seen beside it at the other. Had such a one changed its place instead, no view
/// would differ. Empty where there are not two places. part: all views; ties: those that hold the map
/// together, the found tag's not asked.
std::vector<int> rival_tags(const Observations& observations, const Part& part, const Part& ties,
                            const TagFinding& finding);

}  // namespace apriltrack
