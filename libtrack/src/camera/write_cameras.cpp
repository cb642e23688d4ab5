#include <fmt/format.h>

#include <set>
#include <system_error>

#include "apriltrack/base/error.h"
#include "apriltrack/camera/camera.h"
#include "apriltrack/io/atomic_file.h"
#include "apriltrack/io/numbers.h"
#include "camera_fields.h"

namespace apriltrack {
namespace {

template <class Numbers>
std::string flow_list(const Numbers& numbers) {
  std::string text;
  for (const double number : numbers) text += (text.empty() ? "" : ", ") + format_exact(number);
  return "[" + text + "]";
}

/// A table goes beside the camera file: camera.yaml -> camera_cam0_response.txt.
std::string write_response(const Camera& camera, const std::filesystem::path& path) {
  if (camera.response.name() != "table") return camera.response.name();
  std::error_code ignored;
  if (std::filesystem::exists(path, ignored) && !std::filesystem::is_regular_file(path, ignored)) {
    throw invalid_input(
        path.string(),
        fmt::format("the response table of camera '{}' goes into a file beside the camera file, and "
                    "nothing goes beside what is no regular file: name a file",
                    camera.name));
  }
  const std::string name = fmt::format("{}_{}_response.txt", path.stem().string(), camera.name);
  write_file_atomically(path.parent_path() / name, format_response_table(camera.response));
  return name;
}

/// key: cam0, cam1, ..., whatever the camera is called.
std::string camera_text(const std::string& key, const Camera& camera, const std::filesystem::path& path) {
  const Pinhole& pinhole = camera.model.pinhole();
  const auto coefficients =
      std::visit([](const auto& lens) { return lens.coefficients(); }, camera.model.distortion());
  std::string text = fmt::format("{}:\n", key);
  if (camera.name != key) text += fmt::format("  label: \"{}\"\n", camera.name);
  text += "  camera_model: pinhole\n";
  text +=
      fmt::format("  intrinsics: {}\n",
                  flow_list(std::initializer_list<double>{pinhole.fx, pinhole.fy, pinhole.cx, pinhole.cy}));
  text += fmt::format("  distortion_model: {}\n", camera.model.distortion_name());
  text += fmt::format("  distortion_coeffs: {}\n", flow_list(coefficients));
  text += fmt::format("  resolution: [{}, {}]\n", camera.width, camera.height);
  if (camera.exposure_s) text += fmt::format("  exposure_time: {}\n", format_exact(*camera.exposure_s));
  text += fmt::format("  line_delay: {}\n", format_exact(camera.line_delay_s));
  if (camera.response_origin != ResponseOrigin::kAssumed)
    text += fmt::format(
        "  response: {}{}\n", write_response(camera, path),
        camera.response_origin == ResponseOrigin::kEstimated ? "  # estimated from pictures of tags" : "");
  if (camera.T_this_previous) {
    const Eigen::Matrix4d matrix = camera.T_this_previous->matrix();
    text += "  T_cn_cnm1:\n";
    for (int r = 0; r < 4; ++r) text += fmt::format("  - {}\n", flow_list(matrix.row(r)));
  }
  return text;
}

}  // namespace

void write_cameras(const std::filesystem::path& path, const CameraRig& rig) {
  if (rig.cameras.empty()) throw invalid_input(path.string(), "there is no camera to write");
  std::set<std::string> names;
  for (const Camera& camera : rig.cameras) {
    if (const auto fault = fault_of_camera_name(camera.name)) {
      throw invalid_input(path.string(), fmt::format("the camera's name '{}' {}", camera.name, *fault));
    }
    if (!names.insert(camera.name).second)
      throw invalid_input(path.string(), fmt::format("two cameras are called '{}'", camera.name));
    require_resolution(camera, path);
  }
  std::string text;
  for (std::size_t i = 0; i < rig.cameras.size(); ++i)
    text += camera_text(fmt::format("cam{}", i), rig.cameras[i], path);
  write_file_atomically(path, text);
}

}  // namespace apriltrack
