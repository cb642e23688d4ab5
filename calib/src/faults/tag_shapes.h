#pragma once

#include <optional>

#include "faults/tag_fault.h"

namespace apriltrack {

/// A size or a bend that no frame tells by itself, but all of them do together: the shapes of tags estimated
/// with every pose free to follow, to first order, and what errors a tag keeps weighed in. The clearest of
/// the tags in `solved`; nullopt where none is clear, and where so many are that no tag can be the cause.
std::optional<TagFinding> find_odd_shape(const PartTask& task, const AdjustedPart& solved);

}  // namespace apriltrack
