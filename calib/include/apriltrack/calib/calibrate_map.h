#pragma once

#include <span>

#include "apriltrack/base/log.h"
#include "apriltrack/calib/calibration_options.h"
#include "apriltrack/calib/calibration_result.h"
#include "apriltrack/camera/camera.h"
#include "apriltrack/detect/detection.h"
#include "apriltrack/tags/tag_sizes.h"

namespace apriltrack {

/// Builds a tag map by bundle adjustment: connectivity first, planar solutions resolved, spanning-tree start,
/// robust adjustment with one tag held (docs/algorithms/calibration.md).
///
/// frames: in any order, each camera's with times of their own; those of several cameras with equal time
/// share the rig's pose. rig: needs extrinsics only when several of its cameras were used.
///
/// The tags' covariances rest on the residuals that are left (their size, and how much neighbouring frames
/// repeat them) and on corner_bias_px. Errors that all tags share (a lens that is not the file's, prints that
/// are not as stated) are in them only where they were estimated, or where the views clearly propose them
/// (open_corrections, print_batches, print_aspect, time_errors).
///
/// Throws Error(kNoResult) when no two tags connect, ids are not unique, the adjustment does not converge, or
/// a constraint contradicts all else, and says what to do; Error(kInvalidInput) when a size is missing, a
/// camera is unknown or has two frames of one time, or the held tag or one that a constraint names was never
/// seen. Throws Stopped where the options say so.
CalibrationResult calibrate_map(std::span<const FrameDetections> frames, const CameraRig& rig,
                                const TagSizes& sizes, const CalibrationOptions& options,
                                const LogSink& log = silent_log());

}  // namespace apriltrack
