#include "calibrate_camera.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <variant>
#include <vector>

#include "apriltrack/base/error.h"
#include "apriltrack/camera/auto_response.h"
#include "apriltrack/source/frame_source.h"
#include "files/inputs.h"
#include "files/topics.h"

namespace apriltrack::app {
namespace {
namespace fs = std::filesystem;

bool is_same_lens(const CameraModel& a, const CameraModel& b) {
  const auto numbers = [](const CameraModel& model) {
    const Pinhole& p = model.pinhole();
    std::vector<double> all =
        std::visit([](const auto& lens) { return lens.coefficients(); }, model.distortion());
    all.insert(all.end(), {p.fx, p.fy, p.cx, p.cy});
    return all;
  };
  return a.distortion_name() == b.distortion_name() && numbers(a) == numbers(b);
}

bool is_same_place(const std::optional<Pose>& a, const std::optional<Pose>& b) {
  return a.has_value() == b.has_value() && (!a || a->matrix() == b->matrix());
}

bool is_same_camera(const Camera& a, const Camera& b) {
  return a.name == b.name && a.width == b.width && a.height == b.height && is_same_lens(a.model, b.model) &&
         a.line_delay_s == b.line_delay_s && a.response.linear_light() == b.response.linear_light() &&
         is_same_place(a.T_this_previous, b.T_this_previous);
}

bool is_same_rig(const CameraSource& first, const CameraSource& second, const std::string& topic) {
  const Console console;
  const UnestimatedRig a = read_rig(first, topic, console), b = read_rig(second, topic, console);
  return a.to_estimate == b.to_estimate && std::ranges::equal(a.rig.cameras, b.rig.cameras, is_same_camera);
}

Error without_file(const std::string& input, std::size_t num_inputs) {
  if (num_inputs == 1) return invalid_input("--camera", kNoOwnCamera);
  return invalid_input(
      "--camera",
      fmt::format("is required: '{}' is no sequence folder with a camera.yaml of its own, no EuRoC "
                  "recording with a sensor.yaml, and no bag, and "
                  "another input's need not be the camera that filmed it",
                  input));
}

}  // namespace

CameraSource camera_of(const CalibrateOptions& a) {
  if (!a.camera.empty()) return {a.camera};
  if (a.frames.topics.size() > 1)
    throw invalid_input(
        "--camera",
        "is required: CameraInfo messages do not say where several cameras sit on the rig: give "
        "Kalibr's camchain with T_cn_cnm1");
  const std::string topic = topic_without_camera(a.frames.topics);
  std::optional<CameraSource> first;
  for (const std::string& input : a.inputs) {
    const Recording recording = split_input(input);
    const auto own =
        camera_source("", recording.input, recording.is_named ? recording.camera : a.camera_name);
    if (!own) throw without_file(input, a.inputs.size());
    if (!first) {
      first = own;
    } else if (!is_same_rig(*first, *own, topic)) {
      throw invalid_input("--camera",
                          fmt::format("is required: '{}' and '{}' differ, and a calibration takes one file "
                                      "(of several cameras, if these are of several: cam0=PATH cam1=PATH)",
                                      first->path.string(), own->path.string()));
    }
  }
  if (first) return *first;
  throw invalid_input("--camera", "is required: a detection file brings no camera.yaml of its own");
}

void complete_resolutions(CalibrateOptions& a, const fs::path& file, const std::vector<Recording>& recordings,
                          CameraRig& rig) {
  if (a.calibration.intrinsics == Intrinsics::kKeep && !a.calibration.refine_extrinsics) return;
  for (const Recording& recording : recordings) {
    const auto camera = std::ranges::find(rig.cameras, recording.camera, &Camera::name);
    *camera = with_resolution_of_images(*camera, recording.input, recording.topic);
  }
  const auto without = std::ranges::find_if(
      rig.cameras, [](const Camera& camera) { return camera.width <= 0 || camera.height <= 0; });
  if (without == rig.cameras.end()) return;
  const std::string missing = fmt::format(
      "'resolution' of {} is missing, and no images show it: a refined camera file needs it", without->name);
  if (a.calibration.intrinsics == Intrinsics::kRefine || a.calibration.refine_extrinsics)
    throw invalid_input(
        file.string(),
        missing + "; add resolution: {width: PIXELS, height: PIXELS}, or give --intrinsics keep");
  a.calibration.intrinsics = Intrinsics::kKeep;
  a.console.info(
      fmt::format("{}: {}, so the intrinsics stay as they are (--intrinsics keep)", file.string(), missing));
}

}  // namespace apriltrack::app
