#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <system_error>
#include <utility>

#include "apriltrack/base/degrees.h"
#include "apriltrack/base/error.h"
#include "apriltrack/camera/auto_response.h"
#include "apriltrack/camera/camera.h"
#include "apriltrack/camera/camera_formats.h"
#include "apriltrack/camera/response_tables.h"
#include "apriltrack/camera/ros_topics.h"
#include "apriltrack/io/text_file.h"
#include "camera_fields.h"
#include "formats/formats.h"

namespace apriltrack {
namespace {

std::string titles_of_formats() {
  std::string titles;
  for (const CameraFormatInfo& format : camera_formats())
    titles += (titles.empty() ? "" : ", ") + std::string(format.title);
  return titles;
}

YamlNode read_tree(const CameraText& file) {
  if (is_opencv_xml(file)) return opencv_xml_tree(file);
  const std::size_t first = file.text.find_first_not_of(" \t\r\n");
  const bool is_json =
      file.name.ends_with(".json") || (first != std::string::npos && file.text[first] == '{');
  return is_json ? YamlNode::read_json_text(file.text, file.name) : YamlNode::read_text(file.text, file.name);
}

/// "cam0", but not "camera_matrix".
bool is_camera_name(std::string_view key) {
  return key.size() > 3 && key.starts_with("cam") && std::isdigit(static_cast<unsigned char>(key[3])) != 0;
}

[[noreturn]] void fail_unknown_kind(const YamlNode& root) {
  std::string keys, markers;
  if (root.is_map()) {
    for (const auto& entry : root.entries()) keys += (keys.empty() ? "" : ", ") + entry.first;
  }
  for (const CameraFormatCode& format : camera_format_codes()) {
    if (!format.marker.empty()) markers += (markers.empty() ? "" : ", ") + std::string(format.marker);
  }
  root.fail(
      fmt::format("is no camera file of a known kind ({}); at the top level there must be one of: {}; {}",
                  titles_of_formats(), markers,
                  keys.empty() ? "there are no keys at all" : "there are: " + keys.substr(0, 300)));
}

/// Whose file it is; its tree is read where it has one. nullptr where it is of no known format.
const CameraFormatCode* recognise(CameraText& file) {
  const auto find = [&](bool is_plain_text) -> const CameraFormatCode* {
    const auto formats = camera_format_codes();
    const auto found = std::ranges::find_if(formats, [&](const CameraFormatCode& format) {
      return format.is_plain_text == is_plain_text && format.recognises(file);
    });
    return found == formats.end() ? nullptr : &*found;
  };
  if (const CameraFormatCode* format = find(true)) return format;
  file.root = read_tree(file);
  return file.root->is_map() ? find(false) : nullptr;
}

/// recognise(), for a file that may be of another kind altogether: which are known is told then.
const CameraFormatCode& recognise_unknown(CameraText& file) {
  try {
    if (const CameraFormatCode* format = recognise(file)) return *format;
  } catch (const Error& error) {
    throw Error(error.kind(), error.where(),
                fmt::format("{}; camera files that are read: {}", error.cause(), titles_of_formats()));
  }
  fail_unknown_kind(*file.root);
}

bool is_blank(std::string_view text) {
  return text.find_first_not_of(" \t\r\n") == std::string_view::npos;
}

/// What is no text, with the way to what is.
void refuse_binary(const CameraText& file) {
  if (file.text.find('\0') != std::string::npos) {
    throw invalid_input(
        file.name,
        "is no text file (it holds zero bytes); of COLMAP's cameras.bin, `colmap model_converter "
        "--output_type TXT` makes the cameras.txt that is read");
  }
}

CameraFile read_any(const std::filesystem::path& path, std::vector<std::string>* to_estimate,
                    BeyondOurLenses beyond = BeyondOurLenses::kRefuse) {
  CameraText file{path.string(), read_text_file(path)};
  refuse_binary(file);
  if (is_blank(file.text)) throw invalid_input(file.name, "is empty: a camera file is expected");
  const CameraFormatCode& format = recognise_unknown(file);
  CameraReading reading{path.parent_path(), beyond, to_estimate};
  CameraRig rig = format.read(file, reading);
  return {format.info.format, std::move(rig), std::move(reading.lost)};
}

/// Numbers of a smaller picture beside the size of the whole one: the principal point lies off the middle by
/// one factor in both directions. Cropped pictures do, too, seldom by the same.
std::optional<std::string> sign_of_another_scale(const Camera& camera) {
  const Pinhole& lens = camera.model.pinhole();
  const double x = 2.0 * (lens.cx + 0.5) / camera.width;
  const double y = 2.0 * (lens.cy + 0.5) / camera.height;
  const double scale = 0.5 * (x + y);
  if (std::abs(x - y) > 0.1 * scale || (scale > 0.7 && scale < 1.4)) return std::nullopt;
  return fmt::format(
      "the principal point ({}, {}) is the middle of a picture of {:.0f} x {:.0f} pixels, but the file is of "
      "{} x {}: "
      "were the pictures made smaller or larger before they were calibrated?",
      lens.cx, lens.cy, x * camera.width, y * camera.height, camera.width, camera.height);
}

/// Focal lengths in millimetres, or of a picture of width 1.
std::optional<std::string> sign_of_another_unit(const Camera& camera) {
  // Lenses that are no fisheye end far below the one, telescopes hardly reach the other.
  constexpr double kWidest_rad = 150.0 * kRadPerDeg, kNarrowest_rad = 1.0 * kRadPerDeg;
  const Pinhole& lens = camera.model.pinhole();
  const double view_rad = 2.0 * std::atan(0.5 * std::hypot(camera.width / lens.fx, camera.height / lens.fy));
  const bool is_fisheye = std::holds_alternative<EquidistantDistortion>(camera.model.distortion());
  if ((is_fisheye || view_rad < kWidest_rad) && view_rad > kNarrowest_rad) return std::nullopt;
  return fmt::format(
      "a focal length of {:.4g} x {:.4g} pixels is a field of view of {:.3g} degrees from corner to corner "
      "of {} x {} "
      "pixels: is it in millimetres, or of another picture?",
      lens.fx, lens.fy, kDegPerRad * view_rad, camera.width, camera.height);
}

/// Odd, but it may be meant: cropped pictures, fisheyes with black corners.
void warn_of_oddities(const Camera& camera, const std::string& where, const LogSink& log) {
  if (camera.width == 0) return;
  const auto warn = [&](const std::string& what) {
    log(LogLevel::kWarning, fmt::format("{}: {}: {}", where, camera.name, what));
  };
  const Pinhole& pinhole = camera.model.pinhole();
  if (pinhole.cx <= 0 || pinhole.cy <= 0 || pinhole.cx >= camera.width - 1 ||
      pinhole.cy >= camera.height - 1) {
    warn(fmt::format(
        "the principal point ({}, {}) lies at the edge of the picture of {} x {} pixels, or outside",
        pinhole.cx, pinhole.cy, camera.width, camera.height));
  } else if (const auto sign = sign_of_another_scale(camera)) {
    warn(*sign);
  }
  if (const auto sign = sign_of_another_unit(camera)) warn(*sign);
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

/// What moves points is told here, where all hear of it. What else is lost matters to conversions only.
void tell_oddities(const CameraFile& file, const std::string& where, const LogSink& log) {
  for (const ConversionLoss& loss : file.lost) {
    if (const std::string sentence = sentence_of_moved_points(loss); !sentence.empty())
      log(LogLevel::kWarning, sentence);
  }
  for (const Camera& camera : file.rig.cameras) warn_of_oddities(camera, where, log);
}

/// Of a file of our own format: its mapping; nullopt of others, which have neither responses nor topics, and
/// of pipes, which give what they hold but once, to the reader of cameras.
std::optional<YamlNode> camchain_in(const std::filesystem::path& camera_file) {
  std::error_code ignored;
  if (std::filesystem::is_fifo(camera_file, ignored)) return std::nullopt;
  CameraText file{camera_file.string(), read_text_file(camera_file)};
  const CameraFormatCode* format = recognise(file);
  return format && format->info.format == CameraFormat::kKalibr ? file.root : std::nullopt;
}

}  // namespace

bool is_kalibr_camchain(const CameraText& file) {
  return std::ranges::any_of(file.root->entries(),
                             [](const auto& entry) { return is_camera_name(entry.first); });
}

CameraFile read_camera_file(const std::filesystem::path& path, const LogSink& log, BeyondOurLenses beyond) {
  std::vector<std::string> to_estimate;
  CameraFile file = read_any(path, &to_estimate, beyond);
  for (const std::string& name : to_estimate)
    file.lost.push_back({.kind = LossKind::kResponse, .which = {name}, .value = "auto"});
  tell_oddities(file, path.string(), log);
  return file;
}

CameraRig read_cameras(const std::filesystem::path& path, const LogSink& log) {
  const CameraFile file = read_any(path, nullptr);
  tell_oddities(file, path.string(), log);
  return file.rig;
}

UnestimatedRig read_cameras_to_estimate(const std::filesystem::path& path, const LogSink& log) {
  UnestimatedRig result;
  const CameraFile file = read_any(path, &result.to_estimate);
  tell_oddities(file, path.string(), log);
  result.rig = file.rig;
  return result;
}

std::map<std::string, std::string> ros_topics(const std::filesystem::path& camera_file) {
  const auto root = camchain_in(camera_file);
  std::map<std::string, std::string> topics;
  if (!root) return topics;
  for (const auto& [key, camera] : root->entries()) {
    const auto topic = is_camera_name(key) && camera.is_map() ? camera.find("rostopic") : std::nullopt;
    if (!topic || !topic->is_scalar() || topic->is_null()) continue;
    const auto label = camera.find("label");
    topics[label ? label->as_string() : key] = topic->as_string();
  }
  return topics;
}

std::vector<std::filesystem::path> response_tables(const std::filesystem::path& camera_file) {
  const auto root = camchain_in(camera_file);
  std::vector<std::filesystem::path> tables;
  if (!root) return tables;
  for (const auto& [key, camera] : root->entries()) {
    const auto response = camera.is_map() ? camera.find("response") : std::nullopt;
    if (!response || response->is_map() || response->is_list()) continue;
    const std::filesystem::path table = camera_file.parent_path() / response->as_string();
    std::error_code ignored;
    if (std::filesystem::is_regular_file(table, ignored)) tables.push_back(table);
  }
  return tables;
}

}  // namespace apriltrack
