// EuRoC's state_groundtruth_estimate0/data.csv: nanoseconds, position, quaternion w x y z, velocity, biases
// of gyroscope and accelerometer. evo (evo/tools/file_interface.py, read_euroc_csv_trajectory) takes columns
// 1 to 8 of at least 8, older versions of exactly 17; OpenVINS (ov_core/src/utils/dataset_reader.h,
// load_gt_file) skips the first line and starts from velocity and biases, too.

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "apriltrack/base/error.h"
#include "apriltrack/io/numbers.h"
#include "pose_columns.h"
#include "trajectory_lines.h"
#include "trajectory_texts.h"

namespace apriltrack {
namespace {

/// As in the data set, blanks included: programs find columns by these very words.
constexpr std::string_view kHeader =
    "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z [], "
    "v_RS_R_x [m s^-1], v_RS_R_y [m s^-1], v_RS_R_z [m s^-1], b_w_RS_S_x [rad s^-1], b_w_RS_S_y [rad s^-1], "
    "b_w_RS_S_z [rad s^-1], b_a_RS_S_x [m s^-2], b_a_RS_S_y [m s^-2], b_a_RS_S_z [m s^-2]";
/// What each column's name begins with, the time's aside.
constexpr std::array<std::string_view, 7> kPoseNames = {"p_RS_R_x", "p_RS_R_y", "p_RS_R_z", "q_RS_w",
                                                        "q_RS_x",   "q_RS_y",   "q_RS_z"};
constexpr std::size_t kNumPoseColumns = 8;       // with the time
constexpr std::size_t kNumVelocityColumns = 11;  // those before them included
constexpr std::size_t kEurocColumns = 17;

/// The first line that is not blank, without the `#` that it may begin with.
std::string_view header_of(std::string_view text) {
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    const std::size_t begin = line.find_first_not_of(" \t\r#");
    if (begin != std::string_view::npos) return line.substr(begin);
  }
  return {};
}

/// Without names, seconds or a w that stands last would be read for what they are not.
std::vector<std::string_view> checked_header(std::string_view text, const std::string& name) {
  const std::vector<std::string_view> columns = split_commas(header_of(text));
  const auto fail = [&](const std::string& what) {
    throw invalid_input(
        name, fmt::format("{}; a EuRoC trajectory begins with the line '{}', of which the last nine columns "
                          "may be missing",
                          what, kHeader));
  };
  if (columns.size() < kNumPoseColumns) fail(fmt::format("its header has {} columns", columns.size()));
  if (columns.size() > kEurocColumns) fail(fmt::format("its header has {} columns", columns.size()));
  if (!columns[0].starts_with("timestamp")) fail(fmt::format("its first column is '{}'", columns[0]));
  for (std::size_t i = 0; i < kPoseNames.size(); ++i) {
    if (!columns[i + 1].starts_with(kPoseNames[i]))
      fail(fmt::format("its column {} is '{}', not {}", i + 2, columns[i + 1], kPoseNames[i]));
  }
  return columns;
}

/// numpy writes "1.403636580838555648e+18".
Timestamp euroc_time_of(std::string_view field, const std::string& where) {
  std::string digits = without_exponent(field);
  const std::size_t point = digits.find('.');
  if (point != std::string::npos && digits.find_first_not_of('0', point + 1) == std::string::npos)
    digits.resize(point);
  // A clock may begin in the middle of a recording.
  const bool is_before = digits.starts_with('-');
  if (const auto time = parse_nanoseconds(digits.substr(is_before ? 1 : 0)))
    return is_before ? Timestamp{-time->ns} : *time;
  throw invalid_input(where, fmt::format("timestamp: '{}' is no time in whole nanoseconds", field));
}

PoseLine euroc_pose_of(const ContentLine& line, std::size_t num_columns, const std::string& name) {
  const std::string where = fmt::format("{}:{}", name, line.number);
  const std::vector<std::string_view> fields = split_commas(line.text);
  if (fields.size() != num_columns)
    throw invalid_input(where, fmt::format("has {} fields, the header has {}", fields.size(), num_columns));
  std::array<double, kPoseNames.size()> v{};
  for (std::size_t i = 0; i < v.size(); ++i) v[i] = parse_finite(fields[i + 1], kPoseNames[i], where);
  const auto [tx, ty, tz, qw, qx, qy, qz] = v;
  return {{euroc_time_of(fields[0], where), pose_of_columns({tx, ty, tz, qx, qy, qz, qw}, where)},
          line.number};
}

/// By the positions before and after; of the first and the last pose by its one neighbour.
Eigen::Vector3d velocity_at(const Trajectory& trajectory, std::size_t i) {
  if (trajectory.size() < 2) return Eigen::Vector3d::Zero();
  const TimedPose& before = trajectory[i == 0 ? 0 : i - 1];
  const TimedPose& after = trajectory[std::min(i + 1, trajectory.size() - 1)];
  return (after.pose.translation() - before.pose.translation()) /
         seconds_between(before.timestamp, after.timestamp);
}

}  // namespace

bool has_comma_columns(std::string_view text) {
  return split_commas(header_of(text)).size() >= kNumPoseColumns;
}

Trajectory read_euroc_text(std::string_view text, const std::string& name,
                           std::vector<ConversionLoss>& losses) {
  const std::size_t num_columns = checked_header(text, name).size();
  std::vector<ContentLine> lines = content_lines(text);
  const bool has_bare_header = !lines.empty() && !parse_double(split_commas(lines.front().text).front());
  if (has_bare_header) lines.erase(lines.begin());
  std::vector<PoseLine> poses;
  for (const ContentLine& line : lines) poses.push_back(euroc_pose_of(line, num_columns, name));
  if (num_columns >= kNumVelocityColumns) losses.push_back({LossKind::kVelocities, LossHow::kLeftOut});
  if (num_columns > kNumVelocityColumns) losses.push_back({LossKind::kBiases, LossHow::kLeftOut});
  return sorted_by_time(std::move(poses), name);
}

std::string euroc_text(const Trajectory& trajectory) {
  std::string text = std::string(kHeader) + "\n";
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    const Eigen::Vector3d& p = trajectory[i].pose.translation();
    const Eigen::Quaterniond& q = trajectory[i].pose.rotation();
    const Eigen::Vector3d v = velocity_at(trajectory, i);
    text += fmt::format("{}", trajectory[i].timestamp.ns);
    for (const double value :
         {p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z(), v.x(), v.y(), v.z(), 0.0, 0.0, 0.0, 0.0, 0.0, 0.0})
      text.append(",").append(format_exact(value));
    text += "\n";
  }
  return text;
}

}  // namespace apriltrack
