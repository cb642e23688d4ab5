#pragma once

#include "hypotheses/tag_hypotheses.h"
#include "model/adjusted_part.h"

namespace apriltrack {

/// What is wrong with a tag that had to go.
struct FaultFound {
  TagFinding finding;
  /// Not so where views were chosen for being far off, and no second place explains them: outliers do that.
  bool is_confirmed = true;
  double left = 0.0;  ///< Nats, that its views cost more than they would if the fault were all that is wrong.
};

/// The simplest fault that explains the tag's views as the map without it (`rest`) foretells them; where that
/// says nothing, to first order, as it was found likely in `scored`. part: before outliers were removed.
FaultFound fault_of(const PartTask& task, const Part& part, const AdjustedPart& rest, int tag,
                    const RobustMap* scored = nullptr, const TagHypothesis* fault = nullptr);

}  // namespace apriltrack
