#pragma once

#include <vector>

#include "observations.h"
#include "parts.h"
#include "tag_finding.h"

namespace apriltrack {

/// Of a tag that was found at two places: those others each of which alone joins what was seen beside it at
/// the one place with what was seen beside it at the other. Had such a one changed its place instead, no view
/// would differ. Empty where there are not two places. part: all views; kept: those that a map without the
/// found tag rests on.
std::vector<int> rival_tags(const Observations& observations, const Part& part, const Part& kept,
                            const TagFinding& finding);

}  // namespace apriltrack
