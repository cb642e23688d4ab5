// KITTI's odometry poses (poses/NN.txt of its development kit): the first three rows of T_world_camera,
// twelve numbers a line. Times are in a file of their own, sequences/NN/times.txt, in seconds, a line for
// each pose.

#include <fmt/format.h>

#include <Eigen/LU>
#include <array>

#include "apriltrack/base/error.h"
#include "apriltrack/geometry/rounded_rotation.h"
#include "apriltrack/io/numbers.h"
#include "trajectory_lines.h"
#include "trajectory_texts.h"

namespace apriltrack {
namespace {

constexpr std::size_t kKittiColumns = 12;
/// Files with two decimals are off by 0.01 at most in each of nine numbers.
constexpr double kMostRotationError = 0.05;

std::string column_name(std::size_t i) {
  return fmt::format("{}{}{}", i % 4 == 3 ? "t" : "r", i / 4 + 1,
                     i % 4 == 3 ? "" : std::to_string(i % 4 + 1));
}

/// The nearest rotation, for the numbers are rounded.
Eigen::Matrix3d rotation_of(const Eigen::Matrix3d& matrix, const std::string& where) {
  if (const auto rotation = rounded_rotation(matrix, kMostRotationError)) return *rotation;
  throw invalid_input(where,
                      fmt::format("r11 to r33 are no rotation matrix, by rows (determinant {:.4g}, R R^T "
                                  "is off the identity by up to {:.4g})",
                                  matrix.determinant(), rotation_defect(matrix)));
}

Pose kitti_pose_of(const ContentLine& line, const std::string& name) {
  const std::string where = fmt::format("{}:{}", name, line.number);
  const std::vector<std::string_view> fields = split_blanks(line.text);
  if (fields.size() != kKittiColumns)
    throw invalid_input(where, fmt::format("has {} columns, not the 12 of KITTI's poses: the first three "
                                           "rows of a 4x4 matrix",
                                           fields.size()));
  Eigen::Matrix<double, 3, 4, Eigen::RowMajor> rows;
  for (std::size_t i = 0; i < kKittiColumns; ++i)
    rows.data()[i] = parse_finite(fields[i], column_name(i), where);
  return {rotation_of(rows.leftCols<3>(), where), Eigen::Vector3d(rows.col(3))};
}

}  // namespace

bool has_kitti_columns(std::string_view text) {
  const std::vector<ContentLine> lines = content_lines(text);
  return !lines.empty() && split_blanks(lines.front().text).size() == kKittiColumns;
}

std::vector<Pose> read_kitti_text(std::string_view text, const std::string& name) {
  std::vector<Pose> poses;
  for (const ContentLine& line : content_lines(text)) poses.push_back(kitti_pose_of(line, name));
  return poses;
}

std::vector<Timestamp> read_kitti_times_text(std::string_view text, const std::string& name) {
  std::vector<Timestamp> times;
  for (const ContentLine& line : content_lines(text)) {
    const std::vector<std::string_view> fields = split_blanks(line.text);
    const auto time = fields.size() == 1 ? parse_seconds(without_exponent(fields.front())) : std::nullopt;
    if (!time)
      throw invalid_input(fmt::format("{}:{}", name, line.number),
                          fmt::format("'{}' is no time in seconds; a line of times has one", line.text));
    times.push_back(*time);
  }
  return times;
}

std::string kitti_text(const Trajectory& trajectory) {
  std::string text;
  for (const TimedPose& pose : trajectory) {
    const Eigen::Matrix<double, 3, 4, Eigen::RowMajor> rows = pose.pose.matrix().topRows<3>();
    for (std::size_t i = 0; i < kKittiColumns; ++i)
      text += format_exact(rows.data()[i]) + (i + 1 < kKittiColumns ? " " : "\n");
  }
  return text;
}

std::string kitti_times_text(const Trajectory& trajectory) {
  std::string text;
  for (const TimedPose& pose : trajectory) text += format_seconds(pose.timestamp) + "\n";
  return text;
}

}  // namespace apriltrack
