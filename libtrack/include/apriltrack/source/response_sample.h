#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>

#include "apriltrack/base/should_stop.h"
#include "apriltrack/detect/detector.h"
#include "apriltrack/detect/response_finding.h"
#include "apriltrack/source/frame_source.h"

namespace apriltrack {

/// One recording of a camera whose response is to be estimated.
struct SampledInput {
  std::string input;     ///< As for open_source().
  SourceOptions source;  ///< Of the run that the response is estimated for.
};

/// Estimates a camera's response from tags in a sample of the frames of its recordings: 4 to 8 frames, spread
/// evenly, and up to four times as many where these do not tell it. ResponseFinding::estimate says if none
/// do. Live cameras and pipes give each frame only once, and are not looked at.
///
/// detector: families and search options; its response does not matter. sizes, num_threads: as for
/// estimate_response(). should_stop ends it early, with the estimate until then. Throws as open_source()
/// does.
ResponseFinding response_of_sample(std::span<const SampledInput> inputs, const DetectorOptions& detector,
                                   const ResponseCamera& camera, const TagSizes& sizes, int num_threads,
                                   const ShouldStop& should_stop = {});

/// Detects the tags of a recording by the caller's means, with these responses (of DetectorOptions), and
/// returns its frames with pictures of tags.
using DetectWithResponse = std::function<std::span<const FrameDetections>(
    const ResponseCurve& response, const std::optional<ResponseCurve>& rival)>;

/// Finds the response to detect with, and detects. Calls `detect` with the response that is stated; else with
/// what response_of_sample() finds; else with the assumed one, and, if all its tags tell another and the
/// input can be read again, once more with that. Throws as response_of_sample() and `detect` do.
ResponseFinding run_with_response(const ResponseCamera& camera, ResponseOrigin origin,
                                  const SampledInput& input, const DetectorOptions& detector, int num_threads,
                                  const DetectWithResponse& detect, const ShouldStop& should_stop = {});

}  // namespace apriltrack
