#pragma once

#include <optional>
#include <vector>

#include "part_adjustment.h"

namespace apriltrack {

/// The cameras with other lenses, where the tags' outlines speak against the file's: each view by itself, as
/// the plane square that it shows, wherever that hangs. So no map is needed, and no tag that was moved, or is
/// of a wrong size, tells against a camera. nullopt where the file's lenses will do.
std::optional<std::vector<RigCamera>> lens_by_single_views(const PartTask& task, const Part& part,
                                                           const ParallelFor& parallel);

}  // namespace apriltrack
