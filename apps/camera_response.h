#pragma once

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "apriltrack/camera/camera.h"
#include "apriltrack/detect/detector.h"
#include "apriltrack/detect/estimate_response.h"
#include "apriltrack/source/frame_source.h"
#include "console.h"

namespace apriltrack::app {

/// What is taken for one camera's response, and what pictures of tags say.
struct ResponseFinding {
  std::string camera;
  std::string assumed;  ///< Name of the curve that was taken before pictures were asked.
  ResponseOrigin origin = ResponseOrigin::kStated;  ///< Of what is used.
  ResponseEstimate estimate = {};
  bool is_asked = false;  ///< The user asked for the estimate.

  /// Name of the curve that is used.
  std::string used() const {
    return origin == ResponseOrigin::kEstimated ? estimate.response.name() : assumed;
  }
  /// The curve is another than the camera file's, or was asked for: it is to be written.
  bool is_news() const { return origin == ResponseOrigin::kEstimated && (is_asked || used() != assumed); }
  /// The pictures say another curve than is used.
  bool differs() const {
    return origin != ResponseOrigin::kEstimated && estimate.is_found() && estimate.response.name() != assumed;
  }
};

using ResponseFindings = std::vector<ResponseFinding>;

/// One recording of a camera whose response is to be told.
struct SampledInput {
  std::string input;
  SourceOptions source;
};

ResponseCamera to_ask_of(const Camera& camera);

inline constexpr int kSampleRounds = 4;

/// Frames of one round of the sample: first_frames or some more of `count`, spread evenly, none of which an
/// earlier round has. nullopt where there are none left. all: of the run; round: 0 to kSampleRounds - 1.
std::optional<SourceOptions> frames_of_round(const SourceOptions& all, std::size_t count, int round,
                                             std::size_t first_frames);

/// Estimates a response from tags in some frames of each recording: 4 to 8, spread evenly, and in up to four
/// times as many where these do not tell it. `estimate` says so if none do; live cameras are not asked.
ResponseFinding response_of_sample(std::span<const SampledInput> inputs, const DetectorOptions& detector,
                                   const ResponseCamera& camera, const TagSizes& sizes, int num_threads);

/// Runs `detect`, which keeps the tags with their pictures, with the response that is stated; else with what
/// a sample of the frames tells; else with that assumed, and once more if all its tags tell one and the input
/// can be read again. rival: what it may be as well, for DetectorOptions.
ResponseFinding run_with_response(
    const ResponseCamera& camera, ResponseOrigin origin, const SampledInput& input,
    const DetectorOptions& detector, int num_threads,
    const std::function<std::span<const FrameDetections>(const ResponseCurve& response,
                                                         const std::optional<ResponseCurve>& rival)>& detect);

/// As response_of_sample(), for a camera, whose response becomes the one that is found; says in words what is
/// used.
ResponseFinding estimate_by_sample(std::span<const SampledInput> inputs, const DetectorOptions& detector,
                                   const TagSizes& sizes, int num_threads, const Console& console,
                                   Camera& camera);

/// Holds the response that was used against pictures of tags; origin: of that.
ResponseFinding check_by_frames(std::span<const FrameDetections> frames, const ResponseCamera& camera,
                                ResponseOrigin origin, const TagSizes& sizes, int num_threads);

/// "linear, by 36 pictures of tags: gamma 1.02 (sigma 0.06)", "sRGB, assumed: ...", "linear, as stated".
std::string words_of(const ResponseFinding& finding);
/// What the user must know where a stated response is contradicted, or nothing tells one; nullopt where all
/// is well.
std::optional<std::string> warning_of(const ResponseFinding& finding);
/// Warns, or says what differs without being beyond doubt.
void tell(const ResponseFinding& finding, const Console& console);

/// "stated", "estimated" or "assumed".
const char* word_of(ResponseOrigin origin);
nlohmann::json json_of(const ResponseFinding& finding);

}  // namespace apriltrack::app
