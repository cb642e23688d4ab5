#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "apriltrack/calib/map_constraints.h"
#include "constraints/constrained_fit.h"

namespace apriltrack {

/// Constraints whose lengths are in no metres.
struct OtherUnit {
  std::vector<const MapConstraint*> constraints;  ///< In the order they were given.
  std::string words;                              ///< Which, how far off, and what their unit may be.
};

/// Where most lengths that constraints tell (distances, places on a board, ways from one measured position to
/// the next) are over 10 times as long as in the map, or as short, beyond all errors. Costs next to nothing,
/// where weighing such constraints takes a fit for each.
std::optional<OtherUnit> find_other_unit(std::span<const BoundConstraint> constraints,
                                         const ConstraintPrior& prior);

}  // namespace apriltrack
