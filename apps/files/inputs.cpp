#include "inputs.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "apriltrack/base/error.h"
#include "apriltrack/camera/auto_response.h"
#include "apriltrack/camera/response_tables.h"
#include "apriltrack/source/bag_input.h"
#include "apriltrack/source/frame_source.h"

namespace apriltrack::app {

std::filesystem::path file_or_own(const std::string& given, const std::optional<std::filesystem::path>& own,
                                  std::string_view option, std::string_view name) {
  if (!given.empty()) return given;
  if (own) return *own;
  throw invalid_input(option,
                      fmt::format("is required: the input is no sequence folder with a {} of its own", name));
}

std::vector<std::string> camera_inputs(const std::string& given, const std::vector<std::string>& inputs) {
  std::vector<std::string> files;
  if (!given.empty()) files.push_back(given);
  for (const std::string& input : inputs) {
    const auto own = given.empty() ? sequence_camera_file(input) : std::nullopt;
    if (own) files.push_back(own->string());
  }
  std::vector<std::string> all = {given};
  for (const std::string& file : files)
    for (const std::filesystem::path& table : response_tables(file)) all.push_back(table.string());
  return all;
}

void tell_of_own_camera(const CameraSource& source, const Console& console) {
  if (source.called.empty()) return;
  console.info(fmt::format("{} is the camera file of {}, as the recording brings it (--camera names another)",
                           source.path.string(), source.called));
}

const Camera& camera_named(const CameraRig& rig, const std::string& name, std::string_view where) {
  try {
    return rig.find(name);
  } catch (const Error& error) {
    throw Error(error.kind(), where, error.cause());
  }
}

Camera read_camera(const std::filesystem::path& path, const std::string& name, const Console& console,
                   bool may_have_auto_response) {
  const CameraRig rig = may_have_auto_response ? read_cameras_to_estimate(path, console.log()).rig
                                               : read_cameras(path, console.log());
  return name.empty() ? rig.cameras.front() : camera_named(rig, name, path.string());
}

Camera read_camera(const CameraSource& source, const std::string& name, const Console& console) {
  tell_of_own_camera(source, console);
  if (source.called.empty()) return read_camera(source.path, name, console, true);
  Camera camera = read_camera(source.path, "", console, true);
  camera.name = source.called;
  return camera;
}

std::optional<CameraSource> camera_source(const std::string& given, const std::string& input,
                                          const std::string& camera_name) {
  if (!given.empty()) return CameraSource{given};
  if (is_bag_input(input)) return CameraSource{input};
  if (const auto file = sequence_camera_file(input)) return CameraSource{*file};
  if (const auto file = euroc_camera_file(input, camera_name))
    return CameraSource{*file, camera_name.empty() ? "cam0" : camera_name};
  return std::nullopt;
}

UnestimatedRig read_rig(const CameraSource& source, const std::string& topic, const Console& console) {
  const std::filesystem::path& path = source.path;
  if (!is_bag_input(path.string())) {
    UnestimatedRig rig = read_cameras_to_estimate(path, console.log());
    if (source.called.empty()) return rig;
    rig.rig.cameras.front().name = source.called;
    return rig;
  }
  const std::optional<Camera> camera = bag_camera(path.string(), topic, console.log());
  if (camera) return {{{*camera}}, {}};
  const std::vector<std::string> others = bag_camera_topics(path.string());
  throw invalid_input(
      "--camera",
      fmt::format("is required: {} has no sensor_msgs/CameraInfo or foxglove.CameraCalibration of a "
                  "calibrated camera beside its pictures that can be read{}",
                  path.string(), others.empty() ? "" : fmt::format(" (it has {})", fmt::join(others, ", "))));
}

CameraFile read_camera_input(const std::string& input, const std::string& topic, const Console& console,
                             BeyondOurLenses beyond) {
  if (is_bag_input(input)) return {CameraFormat::kRosCameraInfo, read_rig({input}, topic, console).rig, {}};
  if (!topic.empty())
    throw invalid_input("--topic", fmt::format("is of a bag, and {} is none: leave it out", input));
  return read_camera_file(input, console.log(), beyond);
}

namespace {

/// When the images were taken is not asked: names that are no times get any.
std::unique_ptr<FrameSource> open_without_times(const std::string& input, const std::string& topic) {
  try {
    return open_source(input, {.topic = topic});
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::kInvalidInput) throw;
    return open_source(input, {.rate_hz = 1.0, .topic = topic});
  }
}

}  // namespace

Camera with_resolution_of_images(Camera camera, const std::string& input, const std::string& topic) {
  if (camera.width > 0 && camera.height > 0) return camera;
  const std::unique_ptr<FrameSource> source = open_without_times(input, topic);
  while (const std::optional<SourceFrame> frame = source->next()) {
    if (!frame->is_readable()) continue;
    camera.width = frame->pixels.width();
    camera.height = frame->pixels.height();
    break;
  }
  return camera;
}

void refuse_pipe(const std::string& input) {
  std::error_code ignored;
  if (input == "-" || std::filesystem::is_fifo(input, ignored))
    throw invalid_input("INPUT",
                        fmt::format("'{}' is a pipe, which can be read once, and this reads its "
                                    "pictures more than once: save them to a file (only `detect` and "
                                    "`track` read pipes)",
                                    input));
}

void check_input(const std::string& input) {
  namespace fs = std::filesystem;
  std::error_code error;
  const bool is_pattern = input.find_first_of("*?[") != std::string::npos;
  if (is_pattern || input.starts_with("camera:") || input == "-" || fs::exists(input, error)) return;
  throw io_error(input, error ? error.message() : "no such file or folder");
}

}  // namespace apriltrack::app
