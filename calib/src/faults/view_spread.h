#pragma once

#include <vector>

#include "faults/tag_probe.h"
#include "model/map_state.h"

namespace apriltrack {

/// The aspect and the twist of a tag that is seen from one side alone go with its tilt: what seems bent may
/// be an error that all of its pictures share. Whether the directions from which views see the tag lie within
/// a few degrees of their mean.
bool is_seen_from_one_side(const Observations& observations, const std::vector<std::size_t>& views,
                           const MapState& state, int tag);
bool is_seen_from_one_side(const std::vector<ProbeView>& probes, const Pose& T_map_tag);

}  // namespace apriltrack
