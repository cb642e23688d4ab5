#pragma once

#include <vector>

#include "model/map_state.h"
#include "numerics/linear_view.h"

namespace apriltrack {

/// Of the views' corners, linearised at `state`; those that cannot be projected are left out. Errors that a
/// tag keeps are of its whitened corners, one for each.
std::vector<LinearView> corner_views(const Observations& observations, const std::vector<std::size_t>& views,
                                     const MapState& state);

}  // namespace apriltrack
