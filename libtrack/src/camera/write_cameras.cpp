#include <fmt/format.h>

#include "apriltrack/base/check.h"
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
  const std::string name = fmt::format("{}_{}_response.txt", path.stem().string(), camera.name);
  write_file_atomically(path.parent_path() / name, format_response_table(camera.response));
  return name;
}

std::string camera_text(const Camera& camera, const std::filesystem::path& path) {
  const Pinhole& pinhole = camera.model.pinhole();
  const auto coefficients =
      std::visit([](const auto& lens) { return lens.coefficients(); }, camera.model.distortion());
  std::string text = fmt::format("{}:\n  camera_model: pinhole\n", camera.name);
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
  std::string text;
  for (std::size_t i = 0; i < rig.cameras.size(); ++i) {
    const Camera& camera = rig.cameras[i];
    APRILTRACK_CHECK(camera.name == fmt::format("cam{}", i),
                     "cameras of a file are named cam0, cam1, ... in order");
    APRILTRACK_CHECK(camera.width > 0 && camera.height > 0,
                     "a camera file needs the resolution of its cameras");
    text += camera_text(camera, path);
  }
  write_file_atomically(path, text);
}

}  // namespace apriltrack
