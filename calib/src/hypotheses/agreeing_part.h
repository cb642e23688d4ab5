#pragma once

#include "apriltrack/base/log.h"
#include "apriltrack/base/parallel.h"
#include "initialise/part_adjustment.h"

namespace apriltrack {

/// The part, adjusted; where its frames contradict each other, without the tag that makes them
/// (AdjustedPart::culprits, or those of which any may), or by another focal length, which more of the views
/// agree with. Throws Error(kNoResult) where contradictions stay, and where the tag that the user holds
/// makes them.
AdjustedPart adjust_without_contradictions(const PartTask& task, const Part& part, int held_tag,
                                           const ParallelFor& parallel, const LogSink& log);

}  // namespace apriltrack
