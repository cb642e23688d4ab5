#pragma once

#include <filesystem>
#include <vector>

#include "apriltrack/camera/camera.h"
#include "calibrate_input.h"
#include "calibrate_options.h"
#include "files/inputs.h"

namespace apriltrack::app {

/// --camera, else the recordings' own (camera_source()): the first one's, which the
/// others must equal in all that a calibration asks (not in exposure). Throws Error(kInvalidInput) where an
/// input has none, or two differ.
CameraSource camera_of(const CalibrateOptions& options);

/// Where cameras may be refined, and so written: gives those without a resolution that of their images. Where
/// there are none, Error(kInvalidInput) if refining was asked for, else the intrinsics are kept. file: of
/// `rig`.
void complete_resolutions(CalibrateOptions& options, const std::filesystem::path& file,
                          const std::vector<Recording>& recordings, CameraRig& rig);

}  // namespace apriltrack::app
