#pragma once

#include <optional>
#include <span>

#include "apriltrack/camera/camera.h"
#include "apriltrack/detect/detection.h"

namespace apriltrack {

/// The rig with lenses by which tags look square, of those cameras whose own clearly fails; nullopt where all
/// will do, and where tags were seen in too few places to tell. Each view is judged by itself, wherever its
/// tag hangs and whatever its size (docs/algorithms/calibration.md, eq. 6a); focal lengths come out right to
/// a few percent: a start, and a reason to doubt the file, but no calibration.
///
/// rig: a camera without a distortion model may get one ("radtan"). Throws Error(kInvalidInput) where
/// frames are of a camera that is not in it, or of pictures of another size, or two of one time.
///
/// num_threads: 0 = as many as the machine has cores; changes no result.
std::optional<CameraRig> fit_lenses(std::span<const FrameDetections> frames, const CameraRig& rig,
                                    int num_threads = 1);

}  // namespace apriltrack
