#include "apriltrack/source/response_sample.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <iterator>
#include <thread>
#include <utility>

#include "apriltrack/base/parallel.h"
#include "response_rounds.h"

namespace apriltrack {
namespace {

constexpr std::size_t kFewestSampled = 4, kMostSampled = 8, kOneSampledIn = 10;  // in the first round
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
std::optional<std::size_t> sampled_length(const SampledInput& sampled) {
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
DetectorOptions quick_search(DetectorOptions detector) {
  detector.response = ResponseCurve::linear();
  detector.search_raw_image_only = true;
  detector.refine_edges = false;
  return detector;
}

std::vector<FrameDetections> tags_in(const std::string& input, const SourceOptions& options,
                                     const DetectorOptions& detector, const std::string& camera,
                                     int num_threads, const ShouldStop& should_stop) {
  std::vector<SourceFrame> images;
  const auto source = open_source(input, options);
  while (!asks_to_stop(should_stop)) {
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
    for (std::size_t i = worker; i < images.size() && !asks_to_stop(should_stop); i += workers) {
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

ResponseFinding response_of_sample(std::span<const SampledInput> inputs, const DetectorOptions& detector,
                                   const ResponseCamera& camera, const TagSizes& sizes, int num_threads,
                                   const ShouldStop& should_stop) {
  ResponseFinding finding{camera.name, camera.assumed.name(), ResponseOrigin::kAssumed};
  std::vector<std::optional<std::size_t>> lengths;
  for (const SampledInput& one : inputs) lengths.push_back(sampled_length(one));
  std::vector<FrameDetections> frames;
  for (int round = 0; round < kSampleRounds && !is_enough(finding.estimate) && !asks_to_stop(should_stop);
       ++round) {
    const std::size_t before = frames.size();
    for (std::size_t i = 0; i < inputs.size(); ++i) {
      if (!lengths[i]) continue;
      const std::size_t most = std::max<std::size_t>(1, kMostSampled / inputs.size());
      const std::size_t first = std::clamp(*lengths[i] / kOneSampledIn, std::min(kFewestSampled, most), most);
      const auto some = frames_of_round(inputs[i].source, *lengths[i], round, first);
      if (some)
        std::ranges::move(
            tags_in(inputs[i].input, *some, quick_search(detector), camera.name, num_threads, should_stop),
            std::back_inserter(frames));
    }
    if (frames.size() == before) continue;
    std::ranges::stable_sort(frames, {}, &FrameDetections::timestamp);
    finding.estimate = estimate_response(frames, camera, sizes, num_threads);
  }
  if (finding.estimate.is_found()) finding.origin = ResponseOrigin::kEstimated;
  return finding;
}

ResponseFinding run_with_response(const ResponseCamera& camera, ResponseOrigin origin,
                                  const SampledInput& input, const DetectorOptions& detector, int num_threads,
                                  const DetectWithResponse& detect, const ShouldStop& should_stop) {
  if (origin != ResponseOrigin::kStated) {
    ResponseFinding finding =
        response_of_sample({&input, 1}, detector, camera, TagSizes(), num_threads, should_stop);
    if (finding.origin == ResponseOrigin::kEstimated) {
      detect(finding.estimate.response, std::nullopt);
      return finding;
    }
  }
  const std::span<const FrameDetections> frames =
      detect(camera.assumed, rival_response(camera.assumed, origin));
  ResponseFinding finding = check_by_frames(frames, camera, origin, TagSizes(), num_threads);
  const bool is_settled = origin == ResponseOrigin::kStated || !finding.estimate.is_found();
  if (is_settled || asks_to_stop(should_stop) || !can_be_read_again(input.input)) return finding;
  detect(finding.estimate.response, std::nullopt);  // without a doubt, if not by another curve
  finding.origin = ResponseOrigin::kEstimated;
  return finding;
}

}  // namespace apriltrack
