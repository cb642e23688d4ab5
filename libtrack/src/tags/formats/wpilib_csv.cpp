// FIRST's tables of tags, as WPILib keeps them beside its JSON: ID, X, Y, Z in inches, heading and pitch in
// degrees (apriltag/convert_apriltag_layouts.py of wpilibsuite/allwpilib: rotations about the field's axes,
// first y, then z). The sixth column is the pitch about y by that script, though the header of the 2025 and
// 2026 tables calls it X-Rotation; 2024's has five columns.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <span>
#include <utility>

#include "../tag_faults.h"
#include "apriltrack/base/degrees.h"
#include "apriltrack/base/error.h"
#include "apriltrack/geometry/rotation.h"
#include "apriltrack/io/csv.h"
#include "apriltrack/io/numbers.h"
#include "field.h"
#include "map_words.h"
#include "wpilib.h"

namespace apriltrack {
namespace {

constexpr double kMetresPerInch = 0.0254;
constexpr double kMaxTurn_rad = 1e-9;  // what the two angles may leave of a rotation
constexpr std::array<std::string_view, 5> kYawColumns = {"Rotation", "Z-Rotation", "Z Rotation", "Z_Rotation",
                                                         "ZRotation"};
constexpr std::array<std::string_view, 6> kPitchColumns = {"X-Rotation", "Y-Rotation", "X Rotation",
                                                           "Y Rotation", "X_Rotation", "Y_Rotation"};

/// The column that goes by any of the names; two of them would leave open which is meant.
std::optional<std::string> column_called(const CsvTable& table, std::span<const std::string_view> names,
                                         std::string_view what, const std::string& file) {
  std::optional<std::string> found;
  for (const std::string_view name : names) {
    if (!table.has_column(name)) continue;
    if (found)
      throw invalid_input(
          file, fmt::format("'{}' and '{}' are both columns of the tags' {}: keep one of them", *found, name,
                            what));
    found = std::string(name);
  }
  return found;
}

/// Columns that are passed over.
std::vector<std::string> foreign_columns(const CsvTable& table, const std::vector<std::string>& read) {
  std::vector<std::string> foreign;
  for (const std::string& column : table.columns()) {
    if (!column.empty() && std::ranges::find(read, column) == read.end()) foreign.push_back(column);
  }
  return foreign;
}

double table_coordinate(const CsvTable& table, std::size_t row, const std::string& column) {
  const double position_m = kMetresPerInch * table.number(row, column);
  if (const auto fault = fault_of_coordinate(position_m))
    throw invalid_input(table.where(row), fmt::format("{}: of inches, {}", column, *fault));
  return position_m;
}

int table_id(const CsvTable& table, std::size_t row) {
  const long long id = table.integer(row, "ID");
  if (id < 0 || id > 1'000'000)
    throw invalid_input(table.where(row), fmt::format("ID: must be that of a tag (is {})", id));
  return static_cast<int>(id);
}

Eigen::Quaterniond heading_and_pitch(double yaw_deg, double pitch_deg) {
  return rotation_of_roll_pitch_yaw({0.0, kRadPerDeg * pitch_deg, kRadPerDeg * yaw_deg});
}

/// Yaw and pitch, in degrees; nullopt of a tag that leans to a side.
std::optional<Eigen::Vector2d> yaw_and_pitch_deg(const Eigen::Quaterniond& rotation) {
  const Eigen::Matrix3d R = rotation.toRotationMatrix();
  const double pitch_deg = kDegPerRad * std::atan2(-R(2, 0), std::hypot(R(0, 0), R(1, 0)));
  const double yaw_deg = kDegPerRad * std::atan2(-R(0, 1), R(1, 1));
  if (rotation_angle_rad(heading_and_pitch(yaw_deg, pitch_deg), rotation) > kMaxTurn_rad) return std::nullopt;
  return Eigen::Vector2d(yaw_deg, pitch_deg);
}

}  // namespace

bool is_wpilib_csv(const MapText& text) {
  std::string_view line(text.text);
  if (line.starts_with("\xEF\xBB\xBF")) line.remove_prefix(3);
  line = line.substr(0, line.find('\n'));
  return line.starts_with("ID,X,Y,Z") || line.starts_with("ID, X, Y, Z");
}

MapReading read_wpilib_csv(const MapText& text, const MapReadOptions& options) {
  const CsvTable table = CsvTable::read_text(text.text, text.file, {"ID", "X", "Y", "Z"});
  const auto yaw = column_called(table, kYawColumns, "heading", text.file);
  const auto pitch = column_called(table, kPitchColumns, "pitch", text.file);
  if (!yaw)
    throw invalid_input(text.file, fmt::format("no column tells the tags' heading; one of {} would",
                                               fmt::join(kYawColumns, ", ")));
  std::vector<ForeignTag> tags;
  for (std::size_t row = 0; row < table.num_rows(); ++row) {
    const Eigen::Vector3d position(table_coordinate(table, row, "X"), table_coordinate(table, row, "Y"),
                                   table_coordinate(table, row, "Z"));
    const Pose T_field_theirs(
        heading_and_pitch(table.number(row, *yaw), pitch ? table.number(row, *pitch) : 0.0), position);
    tags.push_back({.place = {table.where(row), ""},
                    .id = table_id(table, row),
                    .T_map_tag = pose_from_frame(T_field_theirs, rotation_wpilib_tag())});
  }
  std::vector<ConversionLoss> losses;
  add_foreign_keys(foreign_columns(table, {"ID", "X", "Y", "Z", *yaw, pitch.value_or("")}), losses);
  MapReading reading =
      map_of(MapFormat::kWpilibCsv, options, text.file, kFieldFrame, tags, std::move(losses), kFrcSizes);
  set_field(reading.map, {options.field, ""});
  return reading;
}

std::string write_wpilib_csv(const TagMap& map, const MapWriteOptions& options, const std::string& file,
                             std::vector<ConversionLoss>& losses) {
  require_distinct_ids(map, MapFormat::kWpilibCsv, file);
  const auto field = agreed_field(field_of(map).size, {file, ""}, options.field);
  const TagMap moved = with_origin(map, kFieldFrame, field, losses);
  if (field) losses.push_back({.kind = LossKind::kFieldSize});
  add_left_out(map, {.frame_name = moved.frame == kFieldFrame}, losses, kFieldExtension);
  std::string out = "ID,X,Y,Z,Z-Rotation,Y-Rotation\n";
  for (const MapTag& tag : moved.tags) {
    const Pose T_field_theirs = pose_to_frame(tag.T_map_tag, rotation_wpilib_tag());
    const auto angles_deg = yaw_and_pitch_deg(T_field_theirs.rotation());
    if (!angles_deg)
      throw invalid_input(file,
                          fmt::format("tag {} leans to a side, and the table holds a heading and a pitch "
                                      "only: write WPILib's JSON (--to wpilib)",
                                      to_string(tag.key)));
    const Eigen::Vector3d inches = T_field_theirs.translation() / kMetresPerInch;
    out +=
        fmt::format("{},{},{},{},{},{}\n", tag.key.id, format_exact(inches.x()), format_exact(inches.y()),
                    format_exact(inches.z()), format_exact(angles_deg->x()), format_exact(angles_deg->y()));
  }
  return out;
}

}  // namespace apriltrack
