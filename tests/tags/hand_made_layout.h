#pragma once

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <fstream>
#include <numbers>
#include <string>
#include <vector>

#include "apriltrack/base/degrees.h"
#include "apriltrack/tags/map_formats.h"
#include "support/error_message.h"
#include "support/pose_matchers.h"
#include "support/shared_data.h"

// Tags whose places are known by geometry alone: where the middle is, which way is right and down for who
// looks at the print. Nothing here knows of quaternions or of another project's frames.
namespace apriltrack::test {

struct PlacedTag {
  Eigen::Vector3d at, right, down;

  Eigen::Vector3d up() const { return -down; }
  Eigen::Vector3d into() const { return right.cross(down); }
  Eigen::Vector3d out() const { return -into(); }
  Pose T_map_tag() const {
    Eigen::Matrix3d R;
    R << right, down, into();
    return {R, at};
  }
};

inline const double kC = std::cos(10.0 * kRadPerDeg);
inline const double kS = std::sin(10.0 * kRadPerDeg);

/// On a wall at x = 3, facing -x, raised by 0.5 m, turned by 10 degrees clockwise for who looks at it.
inline PlacedTag rolled_tag() {
  const Eigen::Vector3d right(0, -1, 0), down(0, 0, -1);
  return {{3, 1, 0.5}, kC * right + kS * down, kC * down - kS * right};
}

/// On the floor, face up, its top towards +y.
inline PlacedTag floor_tag() {
  return {{1, 2, 0}, {1, 0, 0}, {0, -1, 0}};
}

/// Facing +y, leaning back by 20 degrees: its face looks up a little.
inline PlacedTag leaning_tag() {
  const double c = std::cos(20.0 * kRadPerDeg), s = std::sin(20.0 * kRadPerDeg);
  return {{-2, 0.25, 1.5}, {-1, 0, 0}, {0, s, -c}};
}

/// Without the wait for the disk of an atomic write.
inline std::filesystem::path layout_file(const std::string& text, const std::string& name = "layout.txt") {
  const auto path = temporary_folder() / name;
  std::ofstream(path, std::ios::binary) << text;
  return path;
}

inline MapReadOptions with_size(double size_m) {
  MapReadOptions options;
  options.sizes = TagSizes(size_m);
  return options;
}

inline MapReading read_layout(const std::string& text, const MapReadOptions& options = {}) {
  return read_tag_map(layout_file(text), options);
}

inline std::string complaint_about_layout(const std::string& text, const MapReadOptions& options = {}) {
  const auto path = layout_file(text);
  return message_of([&] { read_tag_map(path, options); });
}

inline const ConversionLoss* loss_of(const std::vector<ConversionLoss>& losses, LossKind kind) {
  for (const ConversionLoss& loss : losses) {
    if (loss.kind == kind) return &loss;
  }
  return nullptr;
}

inline MapTag map_tag(const std::string& family, int id, double size_m, const Pose& pose) {
  MapTag tag;
  tag.key = {family, id};
  tag.size_m = size_m;
  tag.T_map_tag = pose;
  return tag;
}

MATCHER_P(IsAt, placed, "") {
  return testing::ExplainMatchResult(PoseNear(placed.T_map_tag(), 1e-9, 1e-9), arg.T_map_tag,
                                     result_listener);
}

}  // namespace apriltrack::test
