#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apriltrack/calib/estimate_response.h"
#include "apriltrack/camera/camera.h"
#include "calibrate_input.h"
#include "calibrate_options.h"

namespace apriltrack::app {

/// What the pictures say of one camera's response.
struct ResponseFinding {
  std::string camera;
  std::string assumed;   ///< Name of the curve that was taken for it.
  bool is_used = false;  ///< The estimated one is used, for it was asked for.
  ResponseEstimate estimate;
  bool differs = false;  ///< The estimated one is another than that taken.
};

using ResponseFindings = std::vector<ResponseFinding>;

/// Estimates the responses that `response: auto` or --response auto asks for, from some frames of each
/// recording, and sets them in `rig`. to_estimate: cameras with `response: auto` in camera_file. Throws
/// Error(kInvalidInput) where there are no images, Error(kNoResult) where the pictures do not tell.
ResponseFindings estimate_responses(const CalibrateOptions& options, const std::filesystem::path& camera_file,
                                    const std::vector<std::string>& to_estimate,
                                    const std::vector<Recording>& recordings, const TagSizes& sizes,
                                    CameraRig& rig);

/// Holds the other cameras' responses against the tags' pictures, and warns where these say otherwise.
void check_responses(const CalibrateOptions& options, const CameraRig& rig, const TagSizes& sizes,
                     const Sightings& sightings, ResponseFindings& findings);

}  // namespace apriltrack::app
