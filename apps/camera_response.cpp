#include "camera_response.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <iterator>
#include <nlohmann/json.hpp>
#include <thread>
#include <utility>

#include "apriltrack/base/error.h"
#include "apriltrack/base/parallel.h"

namespace apriltrack::app {
namespace {

constexpr std::size_t kFewestFrames = 4, kMostFrames = 8, kOneFrameIn = 10;  // in the first round
/// Pictures of tags after which no further round is worth its time.
constexpr int kEnoughPictures = 16;
/// Of a recording that does not tell how long it is.
constexpr std::size_t kAssumedLength = 80;

/// A live camera, or a pipe, gives each frame once, and the run itself needs it.
bool can_be_read_again(const std::string& input) {
  if (input.starts_with("camera:") || input == "-") return false;
  std::error_code ignored;
  const std::filesystem::file_status status = std::filesystem::status(input, ignored);
  return !std::filesystem::exists(status) || std::filesystem::is_regular_file(status) ||
         std::filesystem::is_directory(status);
}

/// The number of frames that a run uses; nullopt where they cannot be looked at beforehand.
std::optional<std::size_t> length_of(const SampledInput& sampled) {
  if (!can_be_read_again(sampled.input)) return std::nullopt;
  SourceOptions options = sampled.source;
  options.log = silent_log();
  const auto source = open_source(sampled.input, options);
  std::optional<std::size_t> count = source->num_frames();
  std::error_code ignored;
  if (!count && std::filesystem::is_regular_file(sampled.input, ignored)) count = kAssumedLength;
  if (count && options.max_frames) count = std::min(*count, *options.max_frames);
  return count;
}

/// Where tags are, to a pixel: one search in the image as it is, and nothing that depends on the response.
DetectorOptions quick(DetectorOptions detector) {
  detector.response = ResponseCurve::linear();
  detector.search_raw_image_only = true;
  detector.refine_edges = false;
  return detector;
}

std::vector<FrameDetections> tags_in(const std::string& input, const SourceOptions& options,
                                     const DetectorOptions& detector, const std::string& camera,
                                     int num_threads) {
  std::vector<SourceFrame> images;
  const auto source = open_source(input, options);
  while (!is_interrupted()) {
    std::optional<SourceFrame> frame = source->next();
    if (!frame) break;
    if (frame->is_readable()) images.push_back(std::move(*frame));
  }
  std::vector<FrameDetections> frames(images.size());
  const auto all = static_cast<std::size_t>(
      num_threads > 0 ? num_threads : std::max(1, static_cast<int>(std::thread::hardware_concurrency())));
  const std::size_t workers = std::min(all, images.size());  // a detector each
  parallel_for(static_cast<int>(workers))(workers, [&](std::size_t worker) {
    Detector finder(detector);
    for (std::size_t i = worker; i < images.size() && !is_interrupted(); i += workers) {
      const GrayView image = images[i].pixels.view();
      frames[i] = {images[i].timestamp, camera, finder.detect(image)};
      for (const Detection& detection : frames[i].detections)
        if (auto patch = cut_patch(image, detection)) frames[i].patches.push_back(std::move(*patch));
    }
  });
  return frames;
}

bool is_enough(const ResponseEstimate& estimate) {
  return estimate.is_found() && estimate.views_used >= kEnoughPictures;
}

std::string readable(const std::string& curve) {
  return curve == "srgb" ? "sRGB" : curve;
}

}  // namespace

std::optional<SourceOptions> frames_of_round(const SourceOptions& all, std::size_t count, int round,
                                             std::size_t first_frames) {
  const std::size_t stride = std::max<std::size_t>(1, count / first_frames);
  // Each round lies in the middle of the gaps that the rounds before leave.
  const std::array<std::size_t, kSampleRounds> begins = {stride / 2, 0, stride / 4, 3 * stride / 4};
  const auto begin = begins.begin() + round;
  if (std::find(begins.begin(), begin, *begin) != begin || *begin >= count) return std::nullopt;
  SourceOptions some = all;
  some.skip += *begin * all.step;
  some.step *= stride;
  some.max_frames = (count - *begin + stride - 1) / stride;
  some.log = silent_log();  // the run itself tells what is odd
  return some;
}

ResponseCamera to_ask_of(const Camera& camera) {
  return {camera.name, camera.model, camera.response};
}

ResponseFinding response_of_sample(std::span<const SampledInput> inputs, const DetectorOptions& detector,
                                   const ResponseCamera& camera, const TagSizes& sizes, int num_threads) {
  ResponseFinding finding{camera.name, camera.assumed.name(), ResponseOrigin::kAssumed};
  std::vector<std::optional<std::size_t>> lengths;
  for (const SampledInput& one : inputs) lengths.push_back(length_of(one));
  std::vector<FrameDetections> frames;
  for (int round = 0; round < kSampleRounds && !is_enough(finding.estimate) && !is_interrupted(); ++round) {
    const std::size_t before = frames.size();
    for (std::size_t i = 0; i < inputs.size(); ++i) {
      if (!lengths[i]) continue;
      const std::size_t most = std::max<std::size_t>(1, kMostFrames / inputs.size());
      const std::size_t first = std::clamp(*lengths[i] / kOneFrameIn, std::min(kFewestFrames, most), most);
      const auto some = frames_of_round(inputs[i].source, *lengths[i], round, first);
      if (some)
        std::ranges::move(tags_in(inputs[i].input, *some, quick(detector), camera.name, num_threads),
                          std::back_inserter(frames));
    }
    if (frames.size() == before) continue;
    std::ranges::stable_sort(frames, {}, &FrameDetections::timestamp);
    finding.estimate = estimate_response(frames, camera, sizes, num_threads);
  }
  if (finding.estimate.is_found()) finding.origin = ResponseOrigin::kEstimated;
  return finding;
}

ResponseFinding run_with_response(
    const ResponseCamera& camera, ResponseOrigin origin, const SampledInput& input,
    const DetectorOptions& detector, int num_threads,
    const std::function<std::span<const FrameDetections>(
        const ResponseCurve& response, const std::optional<ResponseCurve>& rival)>& detect) {
  if (origin != ResponseOrigin::kStated) {
    ResponseFinding finding = response_of_sample({&input, 1}, detector, camera, TagSizes(), num_threads);
    if (finding.origin == ResponseOrigin::kEstimated) {
      detect(finding.estimate.response, std::nullopt);
      return finding;
    }
  }
  const std::span<const FrameDetections> frames =
      detect(camera.assumed, rival_response(camera.assumed, origin));
  ResponseFinding finding = check_by_frames(frames, camera, origin, TagSizes(), num_threads);
  const bool is_settled = origin == ResponseOrigin::kStated || !finding.estimate.is_found();
  if (is_settled || is_interrupted() || !can_be_read_again(input.input)) return finding;
  detect(finding.estimate.response, std::nullopt);  // without a doubt, if not by another curve
  finding.origin = ResponseOrigin::kEstimated;
  return finding;
}

ResponseFinding estimate_by_sample(std::span<const SampledInput> inputs, const DetectorOptions& detector,
                                   const TagSizes& sizes, int num_threads, const Console& console,
                                   Camera& camera) {
  ResponseFinding finding = response_of_sample(inputs, detector, to_ask_of(camera), sizes, num_threads);
  if (finding.origin != ResponseOrigin::kEstimated) return finding;
  camera.response = finding.estimate.response;
  camera.response_origin = ResponseOrigin::kEstimated;
  console.info(fmt::format("camera {}: its response is taken for {}", camera.name, words_of(finding)));
  return finding;
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
      return fmt::format("{}, by {} pictures of tags: {}", readable(finding.used()), estimate.views_used,
                         apriltrack::words_of(estimate));
    case ResponseOrigin::kAssumed:
      return fmt::format("{}, assumed, for {}", readable(finding.used()),
                         estimate.is_found() ? "nothing states it" : words_of_doubt(estimate));
    case ResponseOrigin::kStated:
      break;
  }
  return readable(finding.used()) + ", as stated";
}

std::optional<std::string> warning_of(const ResponseFinding& finding) {
  const ResponseEstimate& estimate = finding.estimate;
  if (finding.origin == ResponseOrigin::kStated && estimate.contradicts_assumed)
    return fmt::format(
        "camera {}: its response is not {} as taken for it (about gamma {:.2f}): the tags' pictures say {}. "
        "Edges seem shifted by up to some tenths of a pixel, distances with them. Use --response auto, or "
        "write `response: {}` into the camera file",
        finding.camera, finding.assumed, estimate.assumed_exponent, apriltrack::words_of(estimate),
        estimate.response.name());
  if (finding.origin == ResponseOrigin::kAssumed && finding.differs())
    return fmt::format(
        "camera {}: {} was taken for its response, which nothing states, and the tags' pictures say {}: "
        "corners are off by up to some tenths of a pixel. Use `response: {}` in the camera file",
        finding.camera, readable(finding.assumed), apriltrack::words_of(estimate), estimate.response.name());
  if (finding.origin == ResponseOrigin::kAssumed && !estimate.is_found())
    return fmt::format(
        "camera {}: its response is in doubt: the camera file states none, and {}. {} is assumed; if it is "
        "another, corners are off by up to some tenths of a pixel. Write what it is into the camera file: "
        "response: srgb (most cameras and videos), linear (most machine-vision cameras) or gamma:G",
        finding.camera, words_of_doubt(estimate), readable(finding.used()));
  return std::nullopt;
}

void tell(const ResponseFinding& finding, const Console& console) {
  if (const auto warning = warning_of(finding)) {
    console.warning(*warning);
  } else if (finding.differs()) {
    console.info(
        fmt::format("camera {}: the tags' pictures say {} of its response rather than {} (about gamma "
                    "{:.2f}), not beyond "
                    "doubt; --response auto takes what they say",
                    finding.camera, apriltrack::words_of(finding.estimate), finding.assumed,
                    finding.estimate.assumed_exponent));
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
