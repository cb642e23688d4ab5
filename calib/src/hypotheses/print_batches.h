#pragma once

#include <optional>
#include <vector>

#include "apriltrack/calib/systematic_errors.h"
#include "initialise/part_adjustment.h"
#include "uncertainty/error_scale.h"
#include "uncertainty/pose_information.h"

namespace apriltrack {

/// Where the sizes of all tags, estimated together with every pose free to follow, fall into two groups that
/// lie clearly apart, so that no one tag can be blamed. nullopt where they do not, and for more tags than a
/// dense system of their sizes is solved for. views: of which `poses` was made, one for each, linearised at
/// `state`; tags: whose sizes are asked for.
std::optional<PrintBatches> find_print_batches(const Observations& observations,
                                               const std::vector<std::size_t>& views, const MapState& state,
                                               const std::vector<int>& tags, const PoseInformation& poses,
                                               const ErrorScale& scale);

/// Where tags that were left out for their size are as many per cent larger, or smaller, all of them, and not
/// few: another print, of which most went one by one. rest: the tags of the map.
std::optional<PrintBatches> print_batches_by(const std::vector<TagFinding>& findings,
                                             const Observations& observations, const std::vector<int>& rest);

/// How the views depend on two errors of unit variance: that either print is not as stated.
std::vector<ParameterView> size_errors(const Observations& observations,
                                       const std::vector<std::size_t>& views, const MapState& state,
                                       const PrintBatches& batches);

}  // namespace apriltrack
