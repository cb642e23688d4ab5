#pragma once

#include <optional>
#include <set>

#include "apriltrack/base/parallel.h"
#include "faults/tag_fault.h"

namespace apriltrack {

/// A move that no frame tells by itself, for its pose follows the tag, but all of them do together: a second
/// pose of each tag from some moment on, with every other pose free to follow, to first order. In a large
/// map by the views of the tag's neighbourhood. The clearest of the tags in `solved`; nullopt where none is
/// clear.
std::optional<TagFinding> find_hidden_move(const PartTask& task, const AdjustedPart& solved,
                                           const ParallelFor& parallel);

/// Whether one of these tags of `solved` moves so, of which it is known that something moved: what is clear
/// of such is less.
bool do_move_again(const PartTask& task, const AdjustedPart& solved, const std::set<int>& tags,
                   const ParallelFor& parallel);

}  // namespace apriltrack
