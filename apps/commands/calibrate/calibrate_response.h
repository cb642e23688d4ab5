#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apriltrack/camera/camera.h"
#include "calibrate_input.h"
#include "calibrate_options.h"
#include "files/camera_response.h"

namespace apriltrack::app {

/// Estimates, from some frames of each recording, the responses that `response: auto` or --response auto asks
/// for and those that the file does not state, and sets them in `rig`. to_estimate: cameras with `response:
/// auto` in camera_file. Where it was asked for: throws Error(kInvalidInput) where there are no images,
/// Error(kNoResult) where the pictures do not tell.
ResponseFindings estimate_responses(const CalibrateOptions& options, const std::filesystem::path& camera_file,
                                    const std::vector<std::string>& to_estimate,
                                    const std::vector<Recording>& recordings, const TagSizes& sizes,
                                    CameraRig& rig);

/// Holds what was stated or assumed against the tags' pictures. True where one that was assumed is told by
/// them, which is set in `rig`: then what was seen is to be gathered anew.
bool check_responses(const CalibrateOptions& options, const std::filesystem::path& camera_file,
                     const std::vector<Recording>& recordings, const TagSizes& sizes,
                     const Sightings& sightings, CameraRig& rig, ResponseFindings& findings);

}  // namespace apriltrack::app
