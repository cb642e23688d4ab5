#pragma once

#include <string>
#include <vector>

#include "constraints/constrained_fit.h"

namespace apriltrack {

/// Whether z of the map's frame is up by what was measured.
bool is_vertical_measured(const ConstrainedFit& fit);

/// How the frame was fixed: by which of `constraints`, and what these leave as the held tag has it. Empty
/// where none tells the frame. held: the tag that the images' map rests on.
std::string gauge_in_words(const ConstrainedFit& fit, const std::vector<BoundConstraint>& constraints,
                           const TagKey& held);

}  // namespace apriltrack
