#pragma once

#include "model/map_state.h"
#include "observations/parts.h"

namespace apriltrack {

/// Takes the directions of the edges, by which corner errors are weighed and edges move, from where the map
/// has the tags instead of from the corners as they were found. Found corners err, and weights that follow
/// these errors pull: of tags 36 px wide with 0.3 px of noise by so much that edges seem a third of a pixel
/// aside, and the map is some per cent too large. views: that agree with the map. Others keep what they have,
/// and so do those that the map has edge-on, or cannot project.
void take_edges_from_map(const std::vector<std::size_t>& views, const MapState& state, const EdgeNoise& noise,
                         Observations& observations);

}  // namespace apriltrack
