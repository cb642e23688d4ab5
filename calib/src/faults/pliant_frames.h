#pragma once

#include <vector>

#include "faults/tag_fit.h"

namespace apriltrack {

/// The probes that remain witnesses against `one`. Small tags, seen from the front, leave a frame two poses,
/// or one within a bent valley that a Gaussian does not describe: what such a frame foretells of the tag may
/// be far off, the same way in neighbouring frames, which looks like a second place. So a view that seems far
/// from `one` is no witness where a pose of its frame explains it there and the others, too.
std::vector<ProbeView> without_pliant_frames(const PartTask& task, const AdjustedPart& solved,
                                             const std::vector<ProbeView>& probes, const TagFit& one);

}  // namespace apriltrack
