#pragma once

#include <optional>
#include <span>

#include "apriltrack/camera/camera.h"
#include "apriltrack/detect/detection.h"

namespace apriltrack {

/// The rig with lenses by which tags look square, where those that it has clearly fail; nullopt where they will
/// do, and where too few tags were seen to tell. Each view is judged by itself, wherever its tag hangs and
/// whatever its size (docs/algorithms/calibration.md, eq. 6d); focal lengths come out right to a few percent:
/// a start, and a reason to doubt the file, but no calibration.
///
/// num_threads: 0 = as many as the machine has cores; changes no result.
std::optional<CameraRig> fit_lenses(std::span<const FrameDetections> frames, const CameraRig& rig,
                                    int num_threads = 1);

}  // namespace apriltrack
