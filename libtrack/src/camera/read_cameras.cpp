#include <fmt/format.h>

#include <cctype>
#include <system_error>

#include "apriltrack/base/error.h"
#include "apriltrack/camera/auto_response.h"
#include "apriltrack/camera/camera.h"
#include "apriltrack/camera/response_tables.h"
#include "apriltrack/camera/ros_topics.h"
#include "apriltrack/io/atomic_file.h"
#include "camera_fields.h"

namespace apriltrack {
namespace {

YamlNode read_tree(const std::filesystem::path& path) {
  const std::string text = read_file(path);
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  const bool is_json = path.extension() == ".json" || (first != std::string::npos && text[first] == '{');
  return is_json ? YamlNode::read_json_text(text, path.string()) : YamlNode::read_text(text, path.string());
}

/// "cam0", but not "camera_matrix".
bool is_camera_name(std::string_view key) {
  return key.size() > 3 && key.starts_with("cam") && std::isdigit(static_cast<unsigned char>(key[3])) != 0;
}

[[noreturn]] void fail_unknown_kind(const YamlNode& root) {
  std::string keys;
  if (root.is_map()) {
    for (const auto& entry : root.entries()) keys += (keys.empty() ? "" : ", ") + entry.first;
  }
  root.fail(fmt::format(
      "is no camera file of a known kind; at the top level there must be one of: 'cam0' (Kalibr camchain), "
      "'camera_matrix' or 'K' (OpenCV FileStorage, ROS camera_info, WPILib JSON), 'cameraIntrinsics' "
      "(PhotonVision JSON), 'intrinsics' with 'distortion_model' (EuRoC sensor.yaml); {}",
      keys.empty() ? "there are no keys at all" : "there are: " + keys.substr(0, 300)));
}

CameraRig read_any(const YamlNode& root, const std::filesystem::path& folder,
                   std::vector<std::string>* to_estimate) {
  if (!root.is_map()) fail_unknown_kind(root);
  for (const auto& entry : root.entries()) {
    if (is_camera_name(entry.first)) return read_kalibr_camchain(root, folder, to_estimate);
  }
  if (has_camera_matrix(root)) return read_matrix_camera(root);
  if (root.find("intrinsics") && root.find("distortion_model")) return read_euroc_sensor(root);
  fail_unknown_kind(root);
}

/// Odd, but it may be meant: cropped pictures, fisheyes with black corners.
void warn_of_oddities(const Camera& camera, const std::string& where, const LogSink& log) {
  if (camera.width == 0) return;
  const auto warn = [&](const std::string& what) {
    log(LogLevel::kWarning, fmt::format("{}: {}: {}", where, camera.name, what));
  };
  const Pinhole& pinhole = camera.model.pinhole();
  if (pinhole.cx < 0 || pinhole.cy < 0 || pinhole.cx > camera.width - 1 || pinhole.cy > camera.height - 1) {
    warn(fmt::format("the principal point ({}, {}) lies outside the picture of {} x {} pixels", pinhole.cx,
                     pinhole.cy, camera.width, camera.height));
  }
  int num_unseen = 0;
  for (const double x : {0.0, camera.width - 1.0}) {
    for (const double y : {0.0, camera.height - 1.0}) num_unseen += camera.model.unproject({x, y}) ? 0 : 1;
  }
  if (num_unseen > 0) {
    warn(fmt::format(
        "the lens model folds back before it reaches {} of the picture's corners; tags there are left out",
        num_unseen));
  }
}

}  // namespace

CameraRig read_cameras(const std::filesystem::path& path, const LogSink& log) {
  CameraRig rig = read_any(read_tree(path), path.parent_path(), nullptr);
  for (const Camera& camera : rig.cameras) warn_of_oddities(camera, path.string(), log);
  return rig;
}

UnestimatedRig read_cameras_to_estimate(const std::filesystem::path& path, const LogSink& log) {
  UnestimatedRig result;
  result.rig = read_any(read_tree(path), path.parent_path(), &result.to_estimate);
  for (const Camera& camera : result.rig.cameras) warn_of_oddities(camera, path.string(), log);
  return result;
}

std::map<std::string, std::string> ros_topics(const std::filesystem::path& camera_file) {
  const YamlNode root = read_tree(camera_file);
  std::map<std::string, std::string> topics;
  if (!root.is_map()) return topics;
  for (const auto& [name, camera] : root.entries()) {
    const auto topic = is_camera_name(name) && camera.is_map() ? camera.find("rostopic") : std::nullopt;
    if (topic && topic->is_scalar() && !topic->is_null()) topics[name] = topic->as_string();
  }
  return topics;
}

std::vector<std::filesystem::path> response_tables(const std::filesystem::path& camera_file) {
  const YamlNode root = read_tree(camera_file);
  std::vector<std::filesystem::path> tables;
  if (!root.is_map()) return tables;
  for (const auto& [key, camera] : root.entries()) {
    const auto response = camera.is_map() ? camera.find("response") : std::nullopt;
    if (!response || response->is_map() || response->is_list()) continue;
    const std::filesystem::path table = camera_file.parent_path() / response->as_string();
    std::error_code ignored;
    if (std::filesystem::is_regular_file(table, ignored)) tables.push_back(table);
  }
  return tables;
}

}  // namespace apriltrack
