// Limelight's .fmap: JSON with a list "fiducials" of family, id, size in mm, a 4x4 transform row by row in
// metres, and whether the tag is unique (docs.limelightvision.io, AprilTag Map Specification). The origin is
// the field's centre. The tag's frame is WPILib's: the published map of 2024 turns tag 1, which WPILib has at
// a heading of 120 degrees, by 120 degrees about z; WPIcal (tools/wpical of wpilibsuite/allwpilib,
// tagpose.cpp) copies WPILib's rotations, too. Some writers give the matrices column by column.
#include "limelight.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "../tag_faults.h"
#include "apriltrack/base/error.h"
#include "apriltrack/io/numbers.h"
#include "apriltrack/tags/tag_family.h"
#include "field.h"
#include "map_words.h"

namespace apriltrack {
namespace {

using Matrix4RowMajor = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;

struct FmapFamily {
  std::string_view kind;    ///< "classic"
  std::string_view prefix;  ///< "tag"
};
constexpr std::array<FmapFamily, 4> kFmapFamilies = {
    {{"classic", "tag"}, {"standard", "tagStandard"}, {"circle", "tagCircle"}, {"custom", "tagCustom"}}};
constexpr std::string_view kFmapPrefix = "apriltag3_";
/// The border of Kalibr's grids is no family of Limelight.
constexpr std::string_view kKalibrFamily = "tag36h11b2";

/// "apriltag3_36h11_classic" is tag36h11.
std::string family_of_fmap(const YamlNode& node) {
  const std::string text = node.as_string();
  const std::size_t end = text.rfind('_');
  for (const FmapFamily& family : kFmapFamilies) {
    if (!text.starts_with(kFmapPrefix) || end < kFmapPrefix.size() || text.substr(end + 1) != family.kind)
      continue;
    const std::string name =
        std::string(family.prefix) + text.substr(kFmapPrefix.size(), end - kFmapPrefix.size());
    if (TagFamily::is_known(name) && name != kKalibrFamily) return name;
  }
  node.fail(
      fmt::format("must be one of AprilTag 3's families, such as apriltag3_36h11_classic (is '{}')", text));
}

std::string fmap_family_of(const TagKey& key, const std::string& file) {
  // Longer prefixes come later, and "tag" begins all of them.
  for (auto family = kFmapFamilies.rbegin(); family != kFmapFamilies.rend(); ++family) {
    if (key.family.starts_with(family->prefix) && key.family != kKalibrFamily)
      return fmt::format("{}{}_{}", kFmapPrefix, key.family.substr(family->prefix.size()), family->kind);
  }
  throw invalid_input(file, fmt::format("tag {}: Limelight has no family {}", to_string(key), key.family));
}

Matrix4RowMajor matrix_of(const YamlNode& node) {
  const std::vector<double> numbers = node.as_doubles(16);
  return Eigen::Map<const Matrix4RowMajor>(numbers.data());
}

bool has_last_row(const Matrix4RowMajor& matrix) {
  return (matrix.row(3) - Eigen::RowVector4d(0.0, 0.0, 0.0, 1.0)).cwiseAbs().maxCoeff() < 1e-9;
}

/// Whether the file has its matrices column by column. One whose last row and last column are both 0 0 0 1 is
/// of a tag in the origin, and tells nothing.
bool is_column_major(const std::vector<YamlNode>& fiducials) {
  std::optional<bool> is_transposed;
  for (const YamlNode& fiducial : fiducials) {
    const YamlNode node = fiducial.at("transform");
    const Matrix4RowMajor matrix = matrix_of(node);
    const bool by_rows = has_last_row(matrix);
    const bool by_columns = has_last_row(matrix.transpose());
    if (!by_rows && !by_columns)
      node.fail(
          "must be a 4x4 matrix row by row, the last row 0 0 0 1 (neither its last row nor its last column "
          "is)");
    if (by_rows && by_columns) continue;
    if (is_transposed && *is_transposed != by_columns)
      node.fail(
          "is written by columns, and others of this file by rows, or the other way round: which is right?");
    is_transposed = by_columns;
  }
  return is_transposed.value_or(false);
}

Pose pose_of_fmap(const YamlNode& node, bool by_columns) {
  Matrix4RowMajor matrix = matrix_of(node);
  if (by_columns) matrix.transposeInPlace();
  const MapPlace place = MapPlace::of(node);
  const Eigen::Vector3d position = matrix.topRightCorner<3, 1>();
  for (const double coordinate_m : position) {
    if (const auto fault = fault_of_coordinate(coordinate_m)) node.fail(*fault);
  }
  return pose_from_frame({checked_rotation(matrix.topLeftCorner<3, 3>(), place), position},
                         rotation_wpilib_tag());
}

ForeignTag tag_of_fmap(const YamlNode& node, bool by_columns, std::vector<std::string>& foreign) {
  note_foreign_keys(node, {"family", "id", "size", "transform", "unique"}, foreign);
  ForeignTag tag;
  tag.place = MapPlace::of(node);
  tag.id = node.at("id").as_int();
  tag.family = family_of_fmap(node.at("family"));
  const YamlNode size = node.at("size");
  tag.size_m = shift_decimal(size.as_double(), -3);
  if (*tag.size_m < 1e-3 && *tag.size_m > 0.0)
    size.fail(fmt::format("is in millimetres, and {:g} mm is no tag: is it in metres?", size.as_double()));
  tag.T_map_tag = pose_of_fmap(node.at("transform"), by_columns);
  return tag;
}

FieldFacts field_of_fmap(const YamlNode& root, const MapReadOptions& options) {
  FieldFacts facts;
  const auto length = root.find("fieldlength");
  const auto width = root.find("fieldwidth");
  std::optional<FieldSize> own;
  if (length && width) own = FieldSize{length->as_double(), width->as_double()};
  facts.size = agreed_field(own, length ? MapPlace::of(*length) : MapPlace::of(root), options.field);
  if (const auto type = root.find("type")) facts.type = type->as_string();
  return facts;
}

std::string text_of_fiducial(const MapTag& tag, const std::string& family) {
  const Eigen::Matrix4d matrix = pose_to_frame(tag.T_map_tag, rotation_wpilib_tag()).matrix();
  std::string numbers;
  for (int i = 0; i < 16; ++i) numbers += (i == 0 ? "" : ", ") + format_exact(matrix(i / 4, i % 4));
  return fmt::format(
      "  {{\"family\": \"{}\", \"id\": {}, \"size\": {}, \"unique\": 1,\n   \"transform\": [{}]}}", family,
      tag.key.id, format_exact(shift_decimal(tag.size_m, 3)), numbers);
}

}  // namespace

bool is_fmap(const MapText& text) {
  return text.root && text.root->is_map() && text.root->find("fiducials");
}

MapReading read_fmap(const MapText& text, const MapReadOptions& options) {
  const YamlNode& root = *text.root;
  std::vector<std::string> foreign;
  note_foreign_keys(root, {"fiducials", "type", "fieldlength", "fieldwidth"}, foreign);
  const std::vector<YamlNode> fiducials = root.at("fiducials").items();
  const bool by_columns = is_column_major(fiducials);
  std::vector<ForeignTag> tags;
  for (const YamlNode& node : fiducials) tags.push_back(tag_of_fmap(node, by_columns, foreign));
  const FieldFacts field = field_of_fmap(root, options);
  std::vector<ConversionLoss> losses;
  if (by_columns) losses.push_back({.kind = LossKind::kMatrixOrder, .how = LossHow::kConverted});
  add_foreign_keys(foreign, losses);
  MapReading reading =
      map_of(MapFormat::kLimelight, options, text.file, kFieldCentreFrame, tags, std::move(losses));
  reading.map = with_origin(reading.map, kFieldFrame, field.size, reading.losses);
  set_field(reading.map, field);
  return reading;
}

std::string write_fmap(const TagMap& map, const MapWriteOptions& options, const std::string& file,
                       std::vector<ConversionLoss>& losses) {
  const FieldFacts field = field_of(map);
  const auto size = agreed_field(field.size, {file, ""}, options.field);
  const TagMap moved = with_origin(map, kFieldCentreFrame, size, losses);
  add_left_out(map, {.sizes = true, .families = true, .frame_name = moved.frame == kFieldCentreFrame}, losses,
               kFieldExtension);
  std::string out = "{\n \"fiducials\": [\n";
  for (std::size_t i = 0; i < moved.tags.size(); ++i) {
    out += text_of_fiducial(moved.tags[i], fmap_family_of(moved.tags[i].key, file));
    out += i + 1 < moved.tags.size() ? ",\n" : "\n";
  }
  out += " ],\n";
  if (size)
    out += fmt::format(" \"fieldlength\": {},\n \"fieldwidth\": {},\n", format_exact(size->length_m),
                       format_exact(size->width_m));
  return out + fmt::format(" \"type\": {}\n}}\n", quoted_text(field.type.empty() ? "frc" : field.type));
}

}  // namespace apriltrack
