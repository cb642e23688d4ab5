#include "camera_response.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "apriltrack/source/response_sample.h"

namespace apriltrack::app {
ResponseFinding estimate_by_sample(std::span<const SampledInput> inputs, const DetectorOptions& detector,
                                   const TagSizes& sizes, int num_threads, const Console& console,
                                   Camera& camera) {
  ResponseFinding finding =
      response_of_sample(inputs, detector, to_ask_of(camera), sizes, num_threads, is_interrupted);
  if (finding.origin != ResponseOrigin::kEstimated) return finding;
  camera.response = finding.estimate.response;
  camera.response_origin = ResponseOrigin::kEstimated;
  console.info(fmt::format("camera {}: its response is taken for {}", camera.name, words_of(finding)));
  return finding;
}

void tell(const ResponseFinding& finding, const Console& console) {
  if (const auto warning = warning_of(finding)) {
    console.warning(*warning);
  } else if (finding.differs()) {
    console.info(fmt::format(
        "camera {}: the tags' pictures say {} of its response rather than {} (about gamma "
        "{:.2f}), not beyond "
        "doubt; --response auto takes what they say",
        finding.camera, words_of(finding.estimate), finding.assumed, finding.estimate.assumed_exponent));
  }
}

const char* word_of(ResponseOrigin origin) {
  switch (origin) {
    case ResponseOrigin::kStated:
      return "stated";
    case ResponseOrigin::kEstimated:
      return "estimated";
    case ResponseOrigin::kAssumed:
      return "assumed";
  }
  return "";
}

namespace {

const char* word_of(ResponseDoubt doubt) {
  switch (doubt) {
    case ResponseDoubt::kNone:
      return "none";
    case ResponseDoubt::kTooFewPictures:
      return "too_few_pictures";
    case ResponseDoubt::kNotExplained:
      return "not_explained";
    case ResponseDoubt::kCannotTell:
      return "cannot_tell";
  }
  return "";
}

}  // namespace

nlohmann::json json_of(const ResponseFinding& finding) {
  const ResponseEstimate& estimate = finding.estimate;
  const bool has_exponent = estimate.sigma > 0.0;
  return {{"camera", finding.camera},
          {"used", finding.used()},
          {"origin", word_of(finding.origin)},
          {"assumed", finding.assumed},
          {"doubt", word_of(estimate.doubt)},
          {"exponent", has_exponent ? nlohmann::json(estimate.exponent) : nlohmann::json()},
          {"sigma", has_exponent ? nlohmann::json(estimate.sigma) : nlohmann::json()},
          {"pictures", estimate.views_used},
          {"frames", estimate.frames_used},
          {"assumed_worse_sigmas", estimate.assumed_worse_sigmas},
          {"contradicted", estimate.contradicts_assumed}};
}

}  // namespace apriltrack::app
