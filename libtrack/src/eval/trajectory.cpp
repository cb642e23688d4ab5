#include "apriltrack/eval/trajectory.h"

#include <fmt/format.h>

#include <array>
#include <string>
#include <string_view>

#include "apriltrack/base/error.h"
#include "apriltrack/io/atomic_file.h"
#include "apriltrack/io/numbers.h"
#include "apriltrack/io/text_file.h"
#include "pose_columns.h"
#include "trajectory_lines.h"
#include "trajectory_texts.h"

namespace apriltrack {
namespace {

constexpr std::size_t kTumColumns = 8;

Timestamp tum_time_of(std::string_view field, const std::string& where) {
  const auto time = parse_seconds(without_exponent(field));
  if (time) return *time;
  const auto whole = parse_integer(field);
  const char* hint = whole ? "; a TUM file has seconds, and this looks like nanoseconds" : "";
  throw invalid_input(where, fmt::format("timestamp: '{}' is no time in seconds{}", field, hint));
}

TimedPose tum_pose_of(const std::vector<std::string_view>& fields, const std::string& where) {
  if (fields.size() != kTumColumns) {
    throw invalid_input(where,
                        fmt::format("has {} columns, not the 8 of TUM format: timestamp tx ty tz qx qy qz qw",
                                    fields.size()));
  }
  std::array<double, kPoseColumns.size()> values{};
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = parse_finite(fields[i + 1], kPoseColumns[i], where);
  const Pose pose = pose_of_columns(values, where);
  return {tum_time_of(fields[0], where), pose};
}

}  // namespace

Trajectory read_tum_text(std::string_view text, const std::string& name) {
  std::vector<PoseLine> lines;
  for (const ContentLine& line : content_lines(text)) {
    const std::string where = fmt::format("{}:{}", name, line.number);
    lines.push_back({tum_pose_of(split_blanks(line.text), where), line.number});
  }
  return sorted_by_time(std::move(lines), name);
}

Trajectory read_tum(const std::filesystem::path& path) {
  return read_tum_text(read_text_file(path, kMaxTableBytes), path.string());
}

std::string tum_line(const TimedPose& pose) {
  std::string line = format_seconds(pose.timestamp);
  const Eigen::Vector3d& t = pose.pose.translation();
  const Eigen::Quaterniond& q = pose.pose.rotation();
  for (const double value : {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()})
    line.append(" ").append(format_exact(value));
  return line + "\n";
}

void write_tum(const std::filesystem::path& path, const Trajectory& trajectory) {
  check_trajectory(trajectory);
  std::string text;
  for (const TimedPose& pose : trajectory) text += tum_line(pose);
  write_file_atomically(path, text);
}

}  // namespace apriltrack
