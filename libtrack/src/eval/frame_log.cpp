#include "apriltrack/eval/frame_log.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <string_view>

#include "apriltrack/base/check.h"
#include "apriltrack/base/error.h"
#include "apriltrack/io/atomic_file.h"
#include "apriltrack/io/csv.h"
#include "pose_columns.h"

namespace apriltrack {
namespace {

constexpr std::array<std::string_view, 5> kStatuses = {"detected", "tracked", "predicted", "lost",
                                                       "unreadable"};

bool is_status(std::string_view word) {
  return std::ranges::find(kStatuses, word) != kStatuses.end();
}

std::string covariance_column(int row, int column) {
  return fmt::format("cov_{}{}", row, column);
}

std::string header() {
  std::string text =
      "timestamp_ns,status,tx,ty,tz,qx,qy,qz,qw,tags_detected,tags_tracked,"
      "sigma_position_m,sigma_rotation_rad,latency_ms,second_mode_odds";
  for (int i = 0; i < 6; ++i) {
    for (int j = i; j < 6; ++j) text.append(",").append(covariance_column(i, j));
  }
  text += ",detection_ms\n";
  return text;
}

void append_pose(std::string& text, const std::optional<Pose>& pose) {
  if (!pose) {
    text.append(kPoseColumns.size(), ',');
    return;
  }
  APRILTRACK_CHECK(pose->is_finite(), "poses of a frame log are finite");
  const Eigen::Vector3d& t = pose->translation();
  const Eigen::Quaterniond& q = pose->rotation();
  for (const double v : {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()})
    fmt::format_to(std::back_inserter(text), ",{:.9f}", v);
}

void append_optional(std::string& text, const std::optional<double>& value) {
  text += value ? fmt::format(",{:.9g}", *value) : ",";
}

std::optional<double> block_sigma(const FrameLogRow& row, int first, const std::optional<double>& given) {
  if (!row.covariance) return given;
  return std::sqrt(row.covariance->diagonal().segment<3>(first).sum());
}

void append_covariance(std::string& text, const std::optional<Matrix6d>& covariance) {
  for (int i = 0; i < 6; ++i) {
    // Twelve digits, so that rounding leaves a badly scaled covariance positive definite.
    for (int j = i; j < 6; ++j) text += covariance ? fmt::format(",{:.12g}", (*covariance)(i, j)) : ",";
  }
}

void append_row(std::string& text, const FrameLogRow& row) {
  APRILTRACK_CHECK(is_status(row.status), "unknown status '" + row.status + "' in a frame log");
  fmt::format_to(std::back_inserter(text), "{},{}", row.timestamp.ns, row.status);
  append_pose(text, row.pose);
  fmt::format_to(std::back_inserter(text), ",{},{}", row.tags_detected, row.tags_tracked);
  append_optional(text, block_sigma(row, 0, row.sigma_position_m));
  append_optional(text, block_sigma(row, 3, row.sigma_rotation_rad));
  text += row.latency_ms ? fmt::format(",{:.3f}", *row.latency_ms) : ",";
  fmt::format_to(std::back_inserter(text), ",{:.6g}", row.second_mode_odds);
  append_covariance(text, row.covariance);
  text += row.detection_ms ? fmt::format(",{:.3f}\n", *row.detection_ms) : ",\n";
}

/// One row of the file; a column that is not there reads as empty.
class RowReader {
 public:
  RowReader(const CsvTable& table, std::size_t row) : table_(table), row_(row) {}

  [[noreturn]] void fail(std::string_view what) const { throw invalid_input(table_.where(row_), what); }

  bool has(std::string_view column) const {
    return table_.has_column(column) && !table_.is_empty(row_, column);
  }
  std::optional<double> number(std::string_view column) const {
    if (!has(column)) return std::nullopt;
    return table_.number(row_, column);
  }
  int count(std::string_view column) const {
    if (!has(column)) return 0;
    const long long value = table_.integer(row_, column);
    if (value < 0 || value > 1'000'000)
      fail(fmt::format("{}: must be a number of tags (is {})", column, value));
    return static_cast<int>(value);
  }

  std::string status() const {
    std::string word(table_.text(row_, "status"));
    if (!is_status(word))
      fail(fmt::format("status: '{}' is none of detected, tracked, predicted, lost, unreadable", word));
    return word;
  }

  std::optional<Pose> pose() const {
    const auto filled =
        std::ranges::count_if(kPoseColumns, [&](std::string_view column) { return has(column); });
    if (filled == 0) return std::nullopt;
    if (filled < static_cast<std::ptrdiff_t>(kPoseColumns.size()))
      fail("tx ... qw: a pose has seven numbers; a frame without one leaves all seven empty");
    std::array<double, kPoseColumns.size()> values{};
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = table_.number(row_, kPoseColumns[i]);
    return pose_of_columns(values, table_.where(row_));
  }

  std::optional<Matrix6d> covariance() const {
    if (!has("cov_00")) return std::nullopt;
    Matrix6d covariance;
    for (int i = 0; i < 6; ++i) {
      for (int j = i; j < 6; ++j) covariance(i, j) = covariance(j, i) = covariance_entry(i, j);
    }
    return covariance;
  }

  std::optional<double> sigma(std::string_view column) const {
    const auto value = number(column);
    if (value && *value < 0.0) fail(fmt::format("{}: must be >= 0 (is {})", column, *value));
    return value;
  }

 private:
  double covariance_entry(int i, int j) const {
    const std::string column = covariance_column(i, j);
    const auto value = number(column);
    if (!value) fail(fmt::format("{}: is missing; a covariance has 21 numbers, cov_00 to cov_55", column));
    if (i == j && *value < 0.0) fail(fmt::format("{}: a variance must be >= 0 (is {})", column, *value));
    return *value;
  }

  const CsvTable& table_;
  std::size_t row_;
};

FrameLogRow read_row(const CsvTable& table, std::size_t index) {
  const RowReader reader(table, index);
  FrameLogRow row;
  row.timestamp.ns = table.integer(index, "timestamp_ns");
  row.status = reader.status();
  row.pose = reader.pose();
  row.tags_detected = reader.count("tags_detected");
  row.tags_tracked = reader.count("tags_tracked");
  row.latency_ms = reader.number("latency_ms");
  row.second_mode_odds = reader.number("second_mode_odds").value_or(0.0);
  row.covariance = reader.covariance();
  row.sigma_position_m = reader.sigma("sigma_position_m");
  row.sigma_rotation_rad = reader.sigma("sigma_rotation_rad");
  row.detection_ms = reader.number("detection_ms");
  return row;
}

}  // namespace

bool claims_evidence(const FrameLogRow& row) {
  return row.status == "detected" || row.status == "tracked";
}

void write_frame_log(const std::filesystem::path& path, const std::vector<FrameLogRow>& rows) {
  std::string text = header();
  for (const FrameLogRow& row : rows) append_row(text, row);
  write_file_atomically(path, text);
}

std::vector<FrameLogRow> read_frame_log(const std::filesystem::path& path) {
  const CsvTable table = CsvTable::read_file(path, {"timestamp_ns", "status"});
  std::vector<FrameLogRow> rows;
  rows.reserve(table.num_rows());
  for (std::size_t i = 0; i < table.num_rows(); ++i) rows.push_back(read_row(table, i));
  return rows;
}

}  // namespace apriltrack
