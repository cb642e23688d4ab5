#pragma once

#include "apriltrack/base/log.h"
#include "part_adjustment.h"

namespace apriltrack {

/// The part without the one tag whose absence leaves no contradictions, and more tags than that of any other.
/// first: the adjusted part with it. Throws Error(kNoResult) that names the most contradicted tags, when
/// there is no such tag, or over half of the frames contradict.
AdjustedPart adjust_without_culprit(const PartTask& task, const Part& part, const AdjustedPart& first,
                                    const ParallelFor& parallel, const LogSink& log);

}  // namespace apriltrack
