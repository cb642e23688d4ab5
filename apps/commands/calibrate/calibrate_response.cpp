#include "calibrate_response.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "apriltrack/base/error.h"
#include "files/inputs.h"

namespace apriltrack::app {
namespace {

std::vector<SampledInput> inputs_of(const CalibrateOptions& a, const std::vector<Recording>& recordings,
                                    const std::string& camera, std::optional<double> exposure_s) {
  std::vector<SampledInput> inputs;
  for (const Recording& recording : recordings) {
    if (recording.camera != camera) continue;
    inputs.push_back({recording.input, a.frames.source});
    inputs.back().source.topic = recording.topic;
    inputs.back().source.exposure_s = exposure_s;
    if (recording.is_named) inputs.back().source.camera_name = recording.camera;
  }
  return inputs;
}

/// What is estimated goes to a file of its own; inputs are never replaced.
void prepare_to_write(const CalibrateOptions& a, const std::filesystem::path& camera_file,
                      const Recording& recording, Camera& camera) {
  camera = with_resolution_of_images(camera, recording.input, recording.topic);
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
    const bool is_wanted = is_asked || camera.response_origin == ResponseOrigin::kAssumed;
    const auto filmed = std::ranges::find(recordings, camera.name, &Recording::camera);
    if (!is_wanted || filmed == recordings.end()) continue;
    ResponseFinding finding = estimate_by_sample(inputs_of(a, recordings, camera.name, camera.exposure_s),
                                                 a.detector, sizes, a.num_threads, a.console, camera);
    if (is_interrupted()) throw no_result("calibrate", kInterruptedAtOnce);
    if (is_asked && !finding.estimate.is_found())
      throw no_result("response: auto",
                      fmt::format("camera {}: {}. Write what it is into {}: response: srgb (most cameras and "
                                  "videos), linear or gamma:G",
                                  camera.name, words_of_doubt(finding.estimate), camera_file.string()));
    finding.is_asked = is_asked;
    if (finding.is_news()) prepare_to_write(a, camera_file, *filmed, camera);
    findings.push_back(std::move(finding));
  }
  return findings;
}

bool check_responses(const CalibrateOptions& a, const std::filesystem::path& camera_file,
                     const std::vector<Recording>& recordings, const TagSizes& sizes,
                     const Sightings& sightings, CameraRig& rig, ResponseFindings& findings) {
  bool is_anew = false;
  for (Camera& camera : rig.cameras) {
    const auto filmed = std::ranges::find(recordings, camera.name, &Recording::camera);
    if (camera.response_origin == ResponseOrigin::kEstimated || filmed == recordings.end()) continue;
    ResponseFinding finding =
        check_by_frames(sightings.frames, to_ask_of(camera), camera.response_origin, sizes, a.num_threads);
    const bool was_stated = finding.origin == ResponseOrigin::kStated;
    if (!was_stated && finding.estimate.is_found()) {
      is_anew = true;  // covariances counted the doubt
      finding.origin = camera.response_origin = ResponseOrigin::kEstimated;
      camera.response = finding.estimate.response;
      if (finding.is_news()) prepare_to_write(a, camera_file, *filmed, camera);
      a.console.info(fmt::format("camera {}: its response is taken for {}", camera.name, words_of(finding)));
    }
    const bool has_tags = std::ranges::any_of(sightings.frames, [&](const FrameDetections& frame) {
      return frame.camera == camera.name && !frame.detections.empty();
    });
    if (has_tags) tell(finding, a.console);
    if (was_stated && !finding.estimate.is_found()) continue;
    std::erase_if(findings, [&](const ResponseFinding& one) { return one.camera == camera.name; });
    findings.push_back(std::move(finding));
  }
  return is_anew;
}

}  // namespace apriltrack::app
