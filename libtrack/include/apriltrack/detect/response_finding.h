#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "apriltrack/camera/camera.h"
#include "apriltrack/detect/estimate_response.h"

namespace apriltrack {

/// The response that is used for one camera, and what pictures of tags say of it.
struct ResponseFinding {
  std::string camera;
  std::string assumed;  ///< Name of the curve (ResponseCurve::name()) that was used before pictures were
                        ///< looked at.
  ResponseOrigin origin = ResponseOrigin::kStated;  ///< Of what is used.
  ResponseEstimate estimate = {};
  bool is_asked = false;  ///< The user asked for the estimate.

  /// Name of the curve that is used.
  std::string used() const {
    return origin == ResponseOrigin::kEstimated ? estimate.response.name() : assumed;
  }
  /// The curve is not the camera file's, or the user asked for it: it has to be written.
  bool is_news() const { return origin == ResponseOrigin::kEstimated && (is_asked || used() != assumed); }
  /// The pictures say a curve that is not used.
  bool differs() const {
    return origin != ResponseOrigin::kEstimated && estimate.is_found() && estimate.response.name() != assumed;
  }
};

using ResponseFindings = std::vector<ResponseFinding>;

/// The camera as estimate_response() asks for it, with its own response as the assumed one.
ResponseCamera to_ask_of(const Camera& camera);

/// Compares the response that was used with the pictures of tags in `frames`. origin: of that response. sizes
/// and num_threads: as for estimate_response().
ResponseFinding check_by_frames(std::span<const FrameDetections> frames, const ResponseCamera& camera,
                                ResponseOrigin origin, const TagSizes& sizes, int num_threads);

/// For people: "linear, by 36 pictures of tags: gamma 1.02 (sigma 0.06)", "sRGB, assumed, for ...", "linear,
/// as stated".
std::string words_of(const ResponseFinding& finding);
/// What the user must know where pictures contradict a stated response, or where nothing tells one; nullopt
/// where all is well.
std::optional<std::string> warning_of(const ResponseFinding& finding);

}  // namespace apriltrack
