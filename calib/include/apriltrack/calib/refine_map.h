#pragma once

#include <span>

#include "apriltrack/base/log.h"
#include "apriltrack/calib/calibration_result.h"
#include "apriltrack/calib/refinement_result.h"
#include "apriltrack/camera/camera.h"
#include "apriltrack/detect/detection.h"

namespace apriltrack {

/// Refines a calibrated map on the pictures of its tags: Gauss-Newton on the light of all their pixels, with
/// the blur of the lens and the light that falls on each tag as unknowns beside all poses
/// (docs/algorithms/photometric_refinement.md).
///
/// frames: those that `calibration` was made from, with their patches; frames without take no part. The
/// refined map is accepted only where the pictures of every fourth moment agree better with a map refined
/// from the other three.
///
/// The refined map keeps to the calibration's constraints; it is not accepted where they contradict the
/// pictures. Where the held tag has no pictures that can be used, it stays where it is, and covariances
/// include what the corners leave open between it and the others; with constraints or estimated cameras, no
/// map is accepted then.
///
/// rig: CalibrationResult::rig, or one of the same cameras. Throws Error(kInvalidInput) for an option out of
/// range, other cameras, or a frame of a camera that the rig does not have.
RefinementResult refine_map(const CalibrationResult& calibration, std::span<const FrameDetections> frames,
                            const CameraRig& rig, const RefinementOptions& options,
                            const LogSink& log = silent_log());

}  // namespace apriltrack
