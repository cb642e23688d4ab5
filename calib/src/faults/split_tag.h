#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "initialise/part_adjustment.h"

namespace apriltrack {

/// With a tag's views at its second place as those of a tag of its own, like it, which is numbered after all
/// others. views: of the tag; is_at_second: of each of these.
Observations split_tag(const Observations& observations, int tag, const std::vector<std::size_t>& views,
                       const std::vector<bool>& is_at_second);

/// From the start, of what hangs together of some views; not held by `tag`. nullopt where nothing fits.
std::optional<AdjustedPart> solve_anew(const PartTask& task, const std::vector<std::size_t>& views, int tag,
                                       MirrorTests tests = MirrorTests::kBeforeAndAfter);

}  // namespace apriltrack
