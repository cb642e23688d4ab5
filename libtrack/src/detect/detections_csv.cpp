#include "apriltrack/detect/detections_csv.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <limits>
#include <map>
#include <utility>

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

Detection detection_at(const CsvTable& table, std::size_t row) {
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

std::string row_of(const FrameDetections& frame, const Detection& detection) {
  std::string row =
      fmt::format("{},{},{},{}", frame.timestamp.ns, frame.camera, detection.tag.family, detection.tag.id);
  for (const Eigen::Vector2d& corner : detection.corners_px)
    fmt::format_to(std::back_inserter(row), ",{:.6f},{:.6f}", corner.x(), corner.y());
  row += detection.hamming ? fmt::format(",{}", *detection.hamming) : ",";
  row += detection.decision_margin ? fmt::format(",{:.3f}\n", *detection.decision_margin) : ",\n";
  return row;
}

}  // namespace

std::vector<FrameDetections> read_detections_csv(const std::filesystem::path& path) {
  std::vector<std::string> columns = {"timestamp_ns", "camera", "family", "id"};
  columns.insert(columns.end(), kCornerColumns.begin(), kCornerColumns.end());
  const CsvTable table = CsvTable::read_file(path, columns);
  std::vector<FrameDetections> frames;
  LatestFrames latest;
  for (std::size_t row = 0; row < table.num_rows(); ++row)
    frame_of(table, row, &latest, &frames).detections.push_back(detection_at(table, row));
  return frames;
}

void write_detections_csv(const std::filesystem::path& path, std::span<const FrameDetections> frames) {
  std::string text = "timestamp_ns,camera,family,id,c0x,c0y,c1x,c1y,c2x,c2y,c3x,c3y,hamming,margin\n";
  for (const FrameDetections& frame : frames)
    for (const Detection& detection : frame.detections) text += row_of(frame, detection);
  write_file_atomically(path, text);
}

}  // namespace apriltrack
