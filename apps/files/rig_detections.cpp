#include "rig_detections.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <set>
#include <system_error>

#include "apriltrack/base/error.h"
#include "apriltrack/detect/detections_csv.h"
#include "apriltrack/detect/picture_size.h"
#include "apriltrack/io/csv.h"
#include "apriltrack/tags/tag_key_fault.h"
#include "inputs.h"

namespace apriltrack::app {
namespace {

/// A pipe cannot be read again.
bool has_lines_still(const std::string& path) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(path, ignored);
}

/// "detections.csv:17"; only asked for where a message needs it, as all places are.
std::string line_of(const std::string& path, const FrameDetections& frame, const Detection& detection) {
  if (!has_lines_still(path)) return path;
  const CsvTable table = CsvTable::read_file(path, {"timestamp_ns", "family", "id", "c0x", "c0y"});
  for (std::size_t row = 0; row < table.num_rows(); ++row) {
    const bool is_it = table.integer(row, "timestamp_ns") == frame.timestamp.ns &&
                       table.text(row, "family") == detection.tag.family &&
                       table.integer(row, "id") == detection.tag.id &&
                       table.number(row, "c0x") == detection.corners_px[0].x() &&
                       table.number(row, "c0y") == detection.corners_px[0].y();
    if (is_it) return table.where(row);
  }
  return path;
}

/// The first line of a camera.
std::string line_of_camera(const std::string& path, const std::string& name) {
  if (!has_lines_still(path)) return path;
  const CsvTable table = CsvTable::read_file(path, {"camera"});
  for (std::size_t row = 0; row < table.num_rows(); ++row)
    if (table.text(row, "camera") == name) return table.where(row);
  return path;
}

bool has_camera(const CameraRig& rig, const std::string& name) {
  return std::ranges::any_of(rig.cameras, [&](const Camera& camera) { return camera.name == name; });
}

/// y is down: bottom-left, bottom-right, top-right, top-left run anticlockwise, and their area is negative.
double signed_area(const std::array<Eigen::Vector2d, kNumCorners>& corners) {
  double sum = 0.0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector2d &a = corners[i], &b = corners[(i + 1) % corners.size()];
    sum += a.x() * b.y() - a.y() * b.x();
  }
  return 0.5 * sum;
}

/// Tags are never seen from behind: where all seem to be, the columns are in another order. Poses and maps
/// would only not come out, and blame the camera.
void refuse_other_corner_order(const std::string& path, const std::vector<FrameDetections>& frames) {
  const Detection* first = nullptr;
  const FrameDetections* first_frame = nullptr;
  for (const FrameDetections& frame : frames) {
    for (const Detection& detection : frame.detections) {
      if (!(signed_area(detection.corners_px) > 0.0)) return;
      if (first) continue;
      first = &detection;
      first_frame = &frame;
    }
  }
  if (!first) return;
  throw invalid_input(line_of(path, *first_frame, *first),
                      "the corners of this tag, and of all others, run clockwise in the picture, as OpenCV's "
                      "ArUco has them (top-left, top-right, bottom-right, bottom-left); c0 to c3 must be "
                      "bottom-left, bottom-right, top-right, top-left");
}

}  // namespace

std::vector<FrameDetections> read_rig_detections(const std::string& path, const CameraRig& rig) {
  std::vector<FrameDetections> frames = read_detections_csv(path);
  refuse_other_corner_order(path, frames);
  if (rig.cameras.size() == 1 && camera_names(frames).size() == 1)
    for (FrameDetections& frame : frames) frame.camera = rig.cameras.front().name;
  return frames;
}

void check_cameras_and_tags(const std::string& path, const CameraRig& rig,
                            const std::vector<FrameDetections>& frames) {
  for (const std::string& name : camera_names(frames))
    if (!has_camera(rig, name)) camera_named(rig, name, line_of_camera(path, name) + ": camera");
  std::set<TagKey> good;
  for (const FrameDetections& frame : frames) {
    for (const Detection& detection : frame.detections) {
      if (good.contains(detection.tag)) continue;
      if (const auto fault = fault_of_key(detection.tag))
        throw invalid_input(
            line_of(path, frame, detection),
            fmt::format("tag {}, which no map can hold: {}; name what is printed, or leave the line out",
                        to_string(detection.tag), *fault));
      good.insert(detection.tag);
    }
  }
}

std::vector<std::string> check_corner_places(const std::string& path, const CameraRig& rig,
                                             const std::vector<FrameDetections>& frames) {
  return check_picture_sizes(
      frames, rig, [&](const auto& frame, const auto& detection) { return line_of(path, frame, detection); });
}

std::vector<std::string> camera_names(const std::vector<FrameDetections>& frames) {
  std::set<std::string> names;
  for (const FrameDetections& frame : frames) names.insert(frame.camera);
  return {names.begin(), names.end()};
}

}  // namespace apriltrack::app
