#pragma once

#include <optional>
#include <vector>

#include "apriltrack/base/parallel.h"
#include "observations.h"

namespace apriltrack {

/// The cameras with other lenses, where the tags' outlines speak against the file's: each view by itself, as
/// the plane square that it shows, wherever that hangs. So no map is needed, and no tag that was moved, or is
/// of a wrong size, tells against a camera. nullopt where the file's lenses will do.
/// views: into observations.views; some of many are looked at.
std::optional<std::vector<RigCamera>> lens_by_single_views(const Observations& observations,
                                                           const std::vector<std::size_t>& views,
                                                           const ParallelFor& parallel);

}  // namespace apriltrack
