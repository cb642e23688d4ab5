#pragma once

#include <optional>

#include "apriltrack/base/log.h"
#include "part_adjustment.h"

namespace apriltrack {

/// The part without the one tag whose absence leaves no contradictions: of several the one whose fault can be
/// named then, and that leaves more tags than any other. nullopt when no tag is clearly the cause.
/// contradictions: of the part with all its tags; none where it could not even be adjusted.
std::optional<AdjustedPart> adjust_without_culprit(const PartTask& task, const Part& part,
                                                   const Contradictions& contradictions, int held_tag,
                                                   const ParallelFor& parallel, const LogSink& log);

/// Throws Error(kNoResult) that names the most contradicted tags.
[[noreturn]] void fail_with_contradictions(const Observations& observations,
                                           const Contradictions& contradictions);

}  // namespace apriltrack
