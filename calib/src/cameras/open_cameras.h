#pragma once

#include <optional>

#include "cameras/camera_refinement.h"

namespace apriltrack {

/// What is not among `refined`: a lens, or places of a rig's cameras, that are clearly off with all else that
/// is unsure; or places or edges that are farther off than expected: no rig is known to a hair, and its
/// baseline scales the map.
std::optional<CameraRefinement> find_open_cameras(const PartTask& task, const CameraRefinement& refined,
                                                  const AdjustedPart& solved);

}  // namespace apriltrack
