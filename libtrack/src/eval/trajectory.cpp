#include "apriltrack/eval/trajectory.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <string>
#include <string_view>

#include "apriltrack/base/check.h"
#include "apriltrack/base/error.h"
#include "apriltrack/io/atomic_file.h"
#include "apriltrack/io/input_file.h"
#include "apriltrack/io/numbers.h"
#include "pose_columns.h"

namespace apriltrack {
namespace {

constexpr std::size_t kNumColumns = 8;
constexpr std::string_view kBlanks = " \t\r";

struct Line {
  TimedPose pose;
  std::size_t number = 0;
};

std::vector<std::string_view> split_blanks(std::string_view text) {
  std::vector<std::string_view> fields;
  for (std::size_t begin = text.find_first_not_of(kBlanks); begin != std::string_view::npos;) {
    const std::size_t end = std::min(text.find_first_of(kBlanks, begin), text.size());
    fields.push_back(text.substr(begin, end - begin));
    begin = text.find_first_not_of(kBlanks, end);
  }
  return fields;
}

/// numpy.savetxt writes times as "1.4036365797e+09"; the point is moved in the text, so that no digit is
/// lost.
std::string without_exponent(std::string_view text) {
  const std::size_t e = text.find_first_of("eE");
  if (e == std::string_view::npos) return std::string(text);
  const auto exponent = parse_integer(text.substr(e + 1));
  if (!exponent || std::abs(*exponent) > 18) return std::string(text);
  std::string mantissa(text.substr(0, e));
  const bool is_negative = mantissa.starts_with('-');
  if (is_negative) mantissa.erase(0, 1);
  std::size_t point = mantissa.find('.');
  if (point == std::string::npos) point = mantissa.size();
  std::string digits = mantissa.substr(0, point) + mantissa.substr(std::min(point + 1, mantissa.size()));
  long long place = static_cast<long long>(point) + *exponent;
  if (place <= 0) {
    digits.insert(0, static_cast<std::size_t>(1 - place), '0');
    place = 1;
  }
  if (digits.size() < static_cast<std::size_t>(place)) digits.resize(static_cast<std::size_t>(place), '0');
  const std::string whole = digits.substr(0, static_cast<std::size_t>(place));
  const std::string decimals = digits.substr(static_cast<std::size_t>(place));
  return (is_negative ? "-" : "") + whole + (decimals.empty() ? "" : "." + decimals);
}

Timestamp parse_time(std::string_view field, const std::string& where) {
  const auto time = parse_seconds(without_exponent(field));
  if (time) return *time;
  const auto whole = parse_integer(field);
  const char* hint = whole ? "; a TUM file has seconds, and this looks like nanoseconds" : "";
  throw invalid_input(where, fmt::format("timestamp: '{}' is no time in seconds{}", field, hint));
}

double parse_finite(std::string_view field, std::string_view column, const std::string& where) {
  const auto value = parse_double(field);
  if (!value || !std::isfinite(*value))
    throw invalid_input(where, fmt::format("{}: '{}' is not a finite number", column, field));
  return *value;
}

TimedPose parse_line(const std::vector<std::string_view>& fields, const std::string& where) {
  if (fields.size() != kNumColumns) {
    throw invalid_input(where,
                        fmt::format("has {} columns, not the 8 of TUM format: timestamp tx ty tz qx qy qz qw",
                                    fields.size()));
  }
  std::array<double, kPoseColumns.size()> values{};
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = parse_finite(fields[i + 1], kPoseColumns[i], where);
  const Pose pose = pose_of_columns(values, where);
  return {parse_time(fields[0], where), pose};
}

std::vector<Line> parse_lines(std::string_view contents, const std::string& name) {
  std::vector<Line> lines;
  std::size_t number = 0;
  while (!contents.empty()) {
    const std::size_t end = std::min(contents.find('\n'), contents.size());
    const std::string_view text = contents.substr(0, end);
    contents.remove_prefix(std::min(end + 1, contents.size()));
    ++number;
    const auto fields = split_blanks(text.substr(0, text.find('#')));
    if (!fields.empty()) lines.push_back({parse_line(fields, fmt::format("{}:{}", name, number)), number});
  }
  return lines;
}

}  // namespace

Trajectory read_tum(const std::filesystem::path& path) {
  std::vector<Line> lines = parse_lines(read_file(path, kMaxTableBytes), path.string());
  std::ranges::stable_sort(lines, {}, [](const Line& line) { return line.pose.timestamp; });
  const auto twin =
      std::ranges::adjacent_find(lines, {}, [](const Line& line) { return line.pose.timestamp; });
  if (twin != lines.end()) {
    throw invalid_input(fmt::format("{}:{}", path.string(), std::next(twin)->number),
                        fmt::format("timestamp {} stands in line {} already; each frame has one pose",
                                    format_seconds(twin->pose.timestamp), twin->number));
  }
  Trajectory trajectory;
  trajectory.reserve(lines.size());
  for (const Line& line : lines) trajectory.push_back(line.pose);
  return trajectory;
}

void write_tum(const std::filesystem::path& path, const Trajectory& trajectory) {
  std::string text;
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    const auto& [timestamp, pose] = trajectory[i];
    APRILTRACK_CHECK(i == 0 || trajectory[i - 1].timestamp < timestamp,
                     "a trajectory is sorted, each time once");
    APRILTRACK_CHECK(pose.is_finite(), "poses of a trajectory are finite");
    const Eigen::Vector3d& t = pose.translation();
    const Eigen::Quaterniond& q = pose.rotation();
    fmt::format_to(std::back_inserter(text), "{} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f}\n",
                   format_seconds(timestamp), t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w());
  }
  write_file_atomically(path, text);
}

}  // namespace apriltrack
