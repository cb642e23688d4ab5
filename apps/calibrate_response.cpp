#include "calibrate_response.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <utility>

#include "apriltrack/base/error.h"
#include "calibrate_output.h"
#include "inputs.h"

namespace apriltrack::app {
namespace {

constexpr std::size_t kSampledFrames = 60;  // of a recording
constexpr std::size_t kStrideOfUnknown = 10;

/// Frames spread over the whole recording.
SourceOptions sampled(const Recording& recording, SourceOptions options) {
  SourceOptions whole = options;
  if (recording.is_named) whole.camera_name = recording.camera;
  const auto count = open_source(recording.input, whole)->num_frames();
  std::size_t stride = kStrideOfUnknown;
  if (count) {
    const std::size_t used = options.max_frames ? std::min(*count, *options.max_frames) : *count;
    stride = std::max<std::size_t>(1, used / kSampledFrames);
  }
  options.step *= stride;
  if (options.max_frames) options.max_frames = std::max<std::size_t>(1, *options.max_frames / stride);
  return options;
}

ResponseEstimate estimate_from(const CalibrateOptions& a, const std::vector<Recording>& recordings,
                               const TagSizes& sizes, const CameraRig& rig, const Camera& camera) {
  std::vector<FrameDetections> frames;
  for (const Recording& recording : recordings) {
    if (recording.camera != camera.name) continue;
    Sightings some =
        detect_in({recording}, rig, a.detector, sampled(recording, a.source), a.num_threads, true, a.console);
    if (some.counts.is_interrupted) throw no_result("calibrate", kInterruptedAtOnce);
    std::move(some.frames.begin(), some.frames.end(), std::back_inserter(frames));
  }
  return estimate_response(frames, camera, sizes, a.num_threads);
}

std::string told_used(const ResponseFinding& finding) {
  const ResponseEstimate& estimate = finding.estimate;
  const std::string name = estimate.response.name();
  const std::string used =
      name.starts_with("gamma:") ? name : fmt::format("{}, which pictures cannot tell from it,", name);
  return fmt::format("camera {}: its response is {}, by {} pictures of tags; {} is used", finding.camera,
                     words_of(estimate), estimate.views_used, used);
}

/// Less than a warning.
std::string told_doubt(const ResponseFinding& finding) {
  return fmt::format(
      "camera {}: the tags' pictures say {} of its response rather than {} (about gamma {:.2f}), "
      "not beyond doubt; --response auto takes what they say",
      finding.camera, words_of(finding.estimate), finding.assumed, finding.estimate.assumed_exponent);
}

std::string warning_of(const ResponseFinding& finding) {
  const ResponseEstimate& estimate = finding.estimate;
  return fmt::format(
      "camera {}: its response is not {} as taken for it (about gamma {:.2f}): the tags' pictures say {}, "
      "and those that were held out agree. Edges seem shifted by up to some tenths of a pixel, distances "
      "with them. Use --response auto, or write `response: {}` into the camera file",
      finding.camera, finding.assumed, estimate.assumed_exponent, words_of(estimate),
      estimate.response.name());
}

/// What is estimated goes to a file of its own; inputs are never replaced.
void require_other_file(const CalibrateOptions& a, const std::filesystem::path& camera_file) {
  std::error_code ignored;
  const std::optional<std::filesystem::path> file = refined_camera_file(a);
  if (!file || !std::filesystem::equivalent(camera_file, *file, ignored)) return;
  throw invalid_input("--output",
                      fmt::format("the camera with its estimated response would replace '{}', which this "
                                  "run reads: name another file",
                                  camera_file.string()));
}

}  // namespace

ResponseFindings estimate_responses(const CalibrateOptions& a, const std::filesystem::path& camera_file,
                                    const std::vector<std::string>& to_estimate,
                                    const std::vector<Recording>& recordings, const TagSizes& sizes,
                                    CameraRig& rig) {
  ResponseFindings findings;
  if (!a.detections.empty() && !to_estimate.empty())
    throw invalid_input(
        camera_file.string(),
        fmt::format("{} has `response: auto`, which is estimated from images: give INPUT in place "
                    "of --detections, or write the response that they were localised with",
                    to_estimate.front()));
  for (Camera& camera : rig.cameras) {
    const bool is_asked = a.estimates_response || std::ranges::count(to_estimate, camera.name) > 0;
    const auto filmed = std::ranges::find(recordings, camera.name, &Recording::camera);
    if (!is_asked || filmed == recordings.end()) continue;
    require_other_file(a, camera_file);
    camera = with_resolution_of_images(camera, filmed->input);  // it is to be written
    ResponseFinding finding{camera.name, camera.response.name(), true,
                            estimate_from(a, recordings, sizes, rig, camera)};
    if (!finding.estimate.is_found)
      throw no_result("response: auto",
                      fmt::format("camera {}: {}. Write what it is into {}: response: srgb (most cameras and "
                                  "videos), linear or gamma:G",
                                  camera.name, finding.estimate.reason, camera_file.string()));
    camera.response = finding.estimate.response;
    a.console.info(told_used(finding));
    findings.push_back(std::move(finding));
  }
  return findings;
}

void check_responses(const CalibrateOptions& a, const CameraRig& rig, const TagSizes& sizes,
                     const Sightings& sightings, ResponseFindings& findings) {
  for (const Camera& camera : rig.cameras) {
    if (std::ranges::count(findings, camera.name, &ResponseFinding::camera) > 0) continue;
    ResponseFinding finding{
        camera.name, camera.response.name(), false,
        estimate_response(sightings.frames, camera, sizes, a.num_threads, kPicturesToCheck)};
    if (!finding.estimate.is_found) continue;
    finding.differs = finding.estimate.response.linear_light() != camera.response.linear_light();
    if (finding.estimate.contradicts_assumed) {
      a.console.warning(warning_of(finding));
    } else if (finding.differs) {
      a.console.info(told_doubt(finding));
    }
    findings.push_back(std::move(finding));
  }
}

}  // namespace apriltrack::app
