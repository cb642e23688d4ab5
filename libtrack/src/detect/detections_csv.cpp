#include "apriltrack/detect/detections_csv.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apriltrack/base/error.h"
#include "apriltrack/io/atomic_file.h"
#include "apriltrack/io/csv.h"

namespace apriltrack {
namespace {

constexpr std::array<std::string_view, 2 * kNumCorners> kCornerColumns = {"c0x", "c0y", "c1x", "c1y",
                                                                          "c2x", "c2y", "c3x", "c3y"};

[[noreturn]] void refuse(const CsvTable& table, std::size_t row, std::string_view column,
                         std::string_view what) {
  throw invalid_input(table.where(row),
                      fmt::format("{}: {} (is '{}')", column, what, table.text(row, column)));
}

std::string name_at(const CsvTable& table, std::size_t row, std::string_view column) {
  if (table.is_empty(row, column)) refuse(table, row, column, "must not be empty");
  return std::string(table.text(row, column));
}

int non_negative_int_at(const CsvTable& table, std::size_t row, std::string_view column) {
  const long long value = table.integer(row, column);
  if (value < 0 || value > std::numeric_limits<int>::max())
    refuse(table, row, column, "must be >= 0 and fit an int");
  return static_cast<int>(value);
}

/// "cov_00", "cov_01", ..., "cov_77": the upper triangle, row by row.
std::vector<std::string> covariance_columns() {
  std::vector<std::string> names;
  for (int i = 0; i < 8; ++i)
    for (int j = i; j < 8; ++j) names.push_back(fmt::format("cov_{}{}", i, j));
  return names;
}

/// nullopt where all of its fields are empty.
std::optional<CornerCovariance> covariance_at(const CsvTable& table, std::size_t row,
                                              const std::vector<std::string>& columns) {
  const auto empty =
      std::ranges::find_if(columns, [&](const std::string& column) { return table.is_empty(row, column); });
  if (empty != columns.end()) {
    const auto full = std::ranges::find_if(
        columns, [&](const std::string& column) { return !table.is_empty(row, column); });
    if (full == columns.end()) return std::nullopt;
    refuse(table, row, *empty, "must be a number where other columns of the covariance are, or all be empty");
  }
  CornerCovariance covariance;
  std::size_t column = 0;
  for (int i = 0; i < 8; ++i)
    for (int j = i; j < 8; ++j) covariance(i, j) = covariance(j, i) = table.number(row, columns[column++]);
  for (int i = 0; i < 8; ++i) {
    if (!(covariance(i, i) > 0.0))
      refuse(table, row, fmt::format("cov_{0}{0}", i), "a variance must be > 0, in px^2");
  }
  if (Eigen::LLT<CornerCovariance>(covariance).info() != Eigen::Success)
    throw invalid_input(table.where(row),
                        "cov_00 ... cov_77: must be the upper triangle, row by row, of a "
                        "positive definite matrix");
  return covariance;
}

/// All of them or none; throws where some are missing.
std::vector<std::string> covariance_columns_of(const CsvTable& table, const std::filesystem::path& path) {
  std::vector<std::string> columns = covariance_columns();
  const auto has = [&](const std::string& column) { return table.has_column(column); };
  if (std::ranges::none_of(columns, has)) return {};
  const auto missing = std::ranges::find_if_not(columns, has);
  if (missing != columns.end())
    throw invalid_input(fmt::format("{}:1", path.string()),
                        fmt::format("{}: column is missing; a covariance needs all 36 columns from cov_00 to "
                                    "cov_77, or none",
                                    *missing));
  return columns;
}

Detection detection_at(const CsvTable& table, std::size_t row,
                       const std::vector<std::string>& covariance_columns) {
  Detection detection;
  detection.tag = {name_at(table, row, "family"), non_negative_int_at(table, row, "id")};
  for (std::size_t k = 0; k < kNumCorners; ++k) {
    detection.corners_px[k] = {table.number(row, kCornerColumns[2 * k]),
                               table.number(row, kCornerColumns[2 * k + 1])};
  }
  if (table.has_column("hamming") && !table.is_empty(row, "hamming"))
    detection.hamming = non_negative_int_at(table, row, "hamming");
  if (table.has_column("margin") && !table.is_empty(row, "margin"))
    detection.decision_margin = table.number(row, "margin");
  if (!covariance_columns.empty()) detection.covariance_px2 = covariance_at(table, row, covariance_columns);
  return detection;
}

/// The last frame of each camera so far, by its index in the frames.
using LatestFrames = std::map<std::string, std::size_t, std::less<>>;

/// The frame that the row belongs to, begun if need be.
FrameDetections& frame_of(const CsvTable& table, std::size_t row, LatestFrames* latest,
                          std::vector<FrameDetections>* frames) {
  const Timestamp timestamp{table.integer(row, "timestamp_ns")};
  const std::string camera = name_at(table, row, "camera");
  const auto found = latest->find(camera);
  if (found != latest->end()) {
    FrameDetections& frame = (*frames)[found->second];
    if (frame.timestamp == timestamp) return frame;
    if (timestamp < frame.timestamp)
      refuse(
          table, row, "timestamp_ns",
          fmt::format(
              "time runs backwards within camera '{}', after {}: sort the lines by time, or give each take "
              "a file of its own",
              camera, frame.timestamp.ns));
  }
  latest->insert_or_assign(camera, frames->size());
  return frames->emplace_back(FrameDetections{timestamp, camera, {}});
}

std::string row_of(const FrameDetections& frame, const Detection& detection, bool with_covariance) {
  std::string row =
      fmt::format("{},{},{},{}", frame.timestamp.ns, frame.camera, detection.tag.family, detection.tag.id);
  for (const Eigen::Vector2d& corner : detection.corners_px)
    fmt::format_to(std::back_inserter(row), ",{:.6f},{:.6f}", corner.x(), corner.y());
  row += detection.hamming ? fmt::format(",{}", *detection.hamming) : ",";
  row += detection.decision_margin ? fmt::format(",{:.3f}", *detection.decision_margin) : ",";
  for (int i = 0; with_covariance && i < 8; ++i)
    for (int j = i; j < 8; ++j)
      row += detection.covariance_px2 ? fmt::format(",{:.6g}", (*detection.covariance_px2)(i, j)) : ",";
  return row + "\n";
}

}  // namespace

std::vector<FrameDetections> read_detections_csv(const std::filesystem::path& path) {
  std::vector<std::string> columns = {"timestamp_ns", "camera", "family", "id"};
  columns.insert(columns.end(), kCornerColumns.begin(), kCornerColumns.end());
  const CsvTable table = CsvTable::read_file(path, columns);
  const std::vector<std::string> of_covariance = covariance_columns_of(table, path);
  std::vector<FrameDetections> frames;
  LatestFrames latest;
  for (std::size_t row = 0; row < table.num_rows(); ++row)
    frame_of(table, row, &latest, &frames).detections.push_back(detection_at(table, row, of_covariance));
  return frames;
}

void write_detections_csv(const std::filesystem::path& path, std::span<const FrameDetections> frames) {
  const bool with_covariance = std::ranges::any_of(frames, [](const FrameDetections& frame) {
    return std::ranges::any_of(frame.detections,
                               [](const Detection& one) { return one.covariance_px2.has_value(); });
  });
  std::string text = "timestamp_ns,camera,family,id,c0x,c0y,c1x,c1y,c2x,c2y,c3x,c3y,hamming,margin";
  if (with_covariance)
    for (const std::string& column : covariance_columns()) text += "," + column;
  text += "\n";
  for (const FrameDetections& frame : frames)
    for (const Detection& detection : frame.detections) text += row_of(frame, detection, with_covariance);
  write_file_atomically(path, text);
}

}  // namespace apriltrack
