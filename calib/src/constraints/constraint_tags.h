#pragma once

#include <span>
#include <vector>

#include "apriltrack/calib/map_constraints.h"

namespace apriltrack {

/// The constraints with every tag named by family and id. Throws Error(kInvalidInput), which says what was
/// seen, where one names a tag that was not seen, or an id that was seen of several families. left_out: seen,
/// but of no use.
std::vector<MapConstraint> with_families(const std::vector<MapConstraint>& constraints,
                                         std::span<const TagKey> seen, std::span<const TagKey> left_out);

}  // namespace apriltrack
