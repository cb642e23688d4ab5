#include "apriltrack/detect/response_finding.h"

#include <fmt/format.h>

namespace apriltrack {
namespace {

std::string readable_curve(const std::string& curve) {
  return curve == "srgb" ? "sRGB" : curve;
}

}  // namespace

ResponseCamera to_ask_of(const Camera& camera) {
  return {camera.name, camera.model, camera.response};
}

ResponseFinding check_by_frames(std::span<const FrameDetections> frames, const ResponseCamera& camera,
                                ResponseOrigin origin, const TagSizes& sizes, int num_threads) {
  const std::size_t pictures = origin == ResponseOrigin::kStated ? kPicturesToCheck : kPicturesToEstimate;
  return {camera.name, camera.assumed.name(), origin,
          estimate_response(frames, camera, sizes, num_threads, pictures)};
}

std::string words_of(const ResponseFinding& finding) {
  const ResponseEstimate& estimate = finding.estimate;
  switch (finding.origin) {
    case ResponseOrigin::kEstimated:
      return fmt::format("{}, by {} pictures of tags: {}", readable_curve(finding.used()),
                         estimate.views_used, words_of(estimate));
    case ResponseOrigin::kAssumed:
      return fmt::format("{}, assumed, for {}", readable_curve(finding.used()),
                         estimate.is_found() ? "nothing states it" : words_of_doubt(estimate));
    case ResponseOrigin::kStated:
      break;
  }
  return readable_curve(finding.used()) + ", as stated";
}

std::optional<std::string> warning_of(const ResponseFinding& finding) {
  const ResponseEstimate& estimate = finding.estimate;
  if (finding.origin == ResponseOrigin::kStated && estimate.contradicts_assumed)
    return fmt::format(
        "camera {}: its response is not {} as taken for it (about gamma {:.2f}): the tags' pictures say {}. "
        "Edges seem shifted by up to some tenths of a pixel, distances with them. Use --response auto, or "
        "write `response: {}` into the camera file",
        finding.camera, finding.assumed, estimate.assumed_exponent, words_of(estimate),
        estimate.response.name());
  if (finding.origin == ResponseOrigin::kAssumed && finding.differs())
    return fmt::format(
        "camera {}: {} was taken for its response, which nothing states, and the tags' pictures say {}: "
        "corners are off by up to some tenths of a pixel. Use `response: {}` in the camera file",
        finding.camera, readable_curve(finding.assumed), words_of(estimate), estimate.response.name());
  if (finding.origin == ResponseOrigin::kAssumed && !estimate.is_found())
    return fmt::format(
        "camera {}: its response is in doubt: the camera file states none, and {}. {} is assumed; if it is "
        "another, corners are off by up to some tenths of a pixel. Write what it is into the camera file: "
        "response: srgb (most cameras and videos), linear (most machine-vision cameras) or gamma:G",
        finding.camera, words_of_doubt(estimate), readable_curve(finding.used()));
  return std::nullopt;
}

}  // namespace apriltrack
