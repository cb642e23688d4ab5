#pragma once

#include <optional>

#include "apriltrack/base/parallel.h"
#include "initialise/part_adjustment.h"

namespace apriltrack {

/// Takes tags out of `solved` whose views leave them a second pose, about as likely
/// (AdjustedPart::undecided), and adjusts the others anew; where the held tag is one of them, another is
/// held. Of the two sides of a joint that is open the one with fewer views goes. part: before outliers were
/// removed; tags that `solved` has lost stay out. Why there is no map, when a tag that the user holds would
/// go, or too little is left; else nullopt.
[[nodiscard]] std::optional<NoMap> leave_out_undecided(const PartTask& task, const Part& part,
                                                       AdjustedPart& solved, const ParallelFor& parallel);

}  // namespace apriltrack
