#pragma once

#include <optional>

#include "apriltrack/base/parallel.h"
#include "observations/observations.h"

namespace apriltrack {

/// The camera with another lens, where the tags' outlines speak against the one it has: each view by itself,
/// as the plane square that it shows, wherever that hangs. So no map is needed, and no tag that was moved, or
/// is of a wrong size, tells against a camera. Of another distortion model where that agrees clearly better.
/// nullopt where the lens will do, or is seen in too few places.
std::optional<CameraModel> lens_by_single_views(const Observations& observations, int camera,
                                                const ParallelFor& parallel);

/// The model, in a form in which its distortion can be estimated.
CameraModel with_distortion(const CameraModel& model);
/// The pinhole with a lens of the model of `like`, that does not distort (of its kind).
CameraModel without_numbers(const CameraModel& like, const Pinhole& pinhole);

}  // namespace apriltrack
