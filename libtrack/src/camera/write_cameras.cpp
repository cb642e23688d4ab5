#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "apriltrack/base/error.h"
#include "apriltrack/camera/camera.h"
#include "apriltrack/camera/response_tables.h"
#include "apriltrack/io/atomic_file.h"
#include "apriltrack/io/numbers.h"
#include "apriltrack/io/quoted_text.h"
#include "apriltrack/io/staged_files.h"
#include "camera_fields.h"

namespace apriltrack {
namespace {

template <class Numbers>
std::string flow_list(const Numbers& numbers) {
  std::string text;
  for (const double number : numbers) text += (text.empty() ? "" : ", ") + format_exact(number);
  return "[" + text + "]";
}

bool has_table(const Camera& camera) {
  return camera.response_origin != ResponseOrigin::kAssumed && camera.response.name() == "table";
}

/// camera.yaml -> camera_cam0_response.txt, by its last name, wherever the camera file is written first.
std::string name_of_table(const std::filesystem::path& path, const Camera& camera) {
  return fmt::format("{}_{}_response.txt", path.stem().string(), camera.name);
}

/// Quoted, since a name may hold what YAML takes for a comment; "./" lest one be read as gamma:G.
std::string response_text(const Camera& camera, const std::filesystem::path& path) {
  return has_table(camera) ? quoted_text("./" + name_of_table(path, camera)) : camera.response.name();
}

void refuse_table_beside_device(const std::filesystem::path& path, const CameraRig& rig) {
  const auto camera = std::ranges::find_if(rig.cameras, has_table);
  if (camera == rig.cameras.end() || !is_written_directly(path)) return;
  throw invalid_input(
      path.string(), fmt::format("the response table of camera '{}' goes into a file beside the camera file, "
                                 "and nothing goes beside what is no regular file: name a file",
                                 camera->name));
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
        "  response: {}{}\n", response_text(camera, path),
        camera.response_origin == ResponseOrigin::kEstimated ? "  # estimated from pictures of tags" : "");
  if (camera.T_this_previous) {
    const Eigen::Matrix4d matrix = camera.T_this_previous->matrix();
    text += "  T_cn_cnm1:\n";
    for (int r = 0; r < 4; ++r) text += fmt::format("  - {}\n", flow_list(matrix.row(r)));
  }
  return text;
}

void check_rig(const std::filesystem::path& path, const CameraRig& rig) {
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
  refuse_table_beside_device(path, rig);
}

}  // namespace

std::vector<std::filesystem::path> response_tables_to_write(const std::filesystem::path& camera_file,
                                                            const CameraRig& rig) {
  std::vector<std::filesystem::path> tables;
  for (const Camera& camera : rig.cameras) {
    if (has_table(camera)) tables.push_back(camera_file.parent_path() / name_of_table(camera_file, camera));
  }
  return tables;
}

void write_cameras(StagedFiles& files, const std::filesystem::path& path, const CameraRig& rig) {
  check_rig(path, rig);
  std::string text;
  for (std::size_t i = 0; i < rig.cameras.size(); ++i) {
    const Camera& camera = rig.cameras[i];
    text += camera_text(fmt::format("cam{}", i), camera, path);
    if (!has_table(camera)) continue;
    files.write(path.parent_path() / name_of_table(path, camera), [&](const auto& place) {
      write_file_atomically(place, format_response_table(camera.response));
    });
  }
  files.write(path, [&](const auto& place) { write_file_atomically(place, text); });
}

void write_cameras(const std::filesystem::path& path, const CameraRig& rig) {
  StagedFiles files;
  write_cameras(files, path, rig);
  files.commit();
}

}  // namespace apriltrack
