// WPILib's field layouts. JSON: AprilTagFieldLayout.cpp and AprilTag.cpp of wpilibsuite/allwpilib, the same
// keys from 2023 to the alphas of 2027 (there in org.wpilib.vision.apriltag), which still hold neither sizes
// nor families (allwpilib issue 6534). Origin: right end of the blue alliance's wall, x along the field.
#include "wpilib.h"

#include <fmt/format.h>

#include "apriltrack/base/error.h"
#include "apriltrack/io/numbers.h"
#include "field.h"
#include "map_words.h"

namespace apriltrack {
namespace {

Pose wpilib_pose_of(const YamlNode& node, std::vector<std::string>& foreign) {
  note_foreign_keys(node, {"translation", "rotation"}, foreign);
  const YamlNode translation = node.at("translation");
  const YamlNode quaternion = node.at("rotation").at("quaternion");
  const auto number = [&](std::string_view key) { return quaternion.at(key).as_double(); };
  const Eigen::Quaterniond rotation =
      read_unit_quaternion(quaternion, number("W"), number("X"), number("Y"), number("Z"));
  const Eigen::Vector3d position(read_coordinate(translation.at("x")), read_coordinate(translation.at("y")),
                                 read_coordinate(translation.at("z")));
  return pose_from_frame({rotation, position}, rotation_wpilib_tag());
}

std::optional<FieldSize> wpilib_field_of(const YamlNode& root, const MapReadOptions& options,
                                         std::vector<std::string>& foreign) {
  const auto node = root.find("field");
  if (!node) return options.field;
  note_foreign_keys(*node, {"length", "width"}, foreign);
  const FieldSize own{node->at("length").as_double(), node->at("width").as_double()};
  return agreed_field(own, MapPlace::of(*node), options.field);
}

std::string wpilib_tag_text(const MapTag& tag) {
  const Pose T_field_tag = pose_to_frame(tag.T_map_tag, rotation_wpilib_tag());
  const Eigen::Vector3d& p = T_field_tag.translation();
  const Eigen::Quaterniond& q = T_field_tag.rotation();
  return fmt::format(
      "  {{\n   \"ID\": {},\n   \"pose\": {{\n    \"translation\": {{\"x\": {}, \"y\": {}, \"z\": {}}},\n"
      "    \"rotation\": {{\"quaternion\": {{\"W\": {}, \"X\": {}, \"Y\": {}, \"Z\": {}}}}}\n   }}\n  }}",
      tag.key.id, format_exact(p.x()), format_exact(p.y()), format_exact(p.z()), format_exact(q.w()),
      format_exact(q.x()), format_exact(q.y()), format_exact(q.z()));
}

}  // namespace

const UsualSizes kFrcSizes{
    "FRC's fields have 0.1651 m (2024 and later, tag36h11) or 0.1524 m (2023, tag16h5), FTC's several sizes"};

bool is_wpilib_json(const MapText& text) {
  if (!text.root || !text.root->is_map()) return false;
  const auto tags = text.root->find("tags");
  if (!tags || !tags->is_list()) return false;
  const auto items = tags->items();
  if (items.empty()) return text.root->find("field").has_value();
  return items.front().is_map() && items.front().find("ID").has_value();
}

MapReading read_wpilib_json(const MapText& text, const MapReadOptions& options) {
  std::vector<std::string> foreign;
  const YamlNode& root = *text.root;
  note_foreign_keys(root, {"tags", "field"}, foreign);
  std::vector<ForeignTag> tags;
  for (const YamlNode& item : root.at("tags").items()) {
    note_foreign_keys(item, {"ID", "pose"}, foreign);
    tags.push_back({.place = MapPlace::of(item),
                    .id = item.at("ID").as_int(),
                    .T_map_tag = wpilib_pose_of(item.at("pose"), foreign)});
  }
  const auto field = wpilib_field_of(root, options, foreign);
  std::vector<ConversionLoss> losses;
  add_foreign_keys(foreign, losses);
  MapReading reading =
      map_of(MapFormat::kWpilibJson, options, text.file, kFieldFrame, tags, std::move(losses), kFrcSizes);
  set_field(reading.map, {field, ""});
  return reading;
}

std::string write_wpilib_json(const TagMap& map, const MapWriteOptions& options, const std::string& file,
                              std::vector<ConversionLoss>& losses) {
  require_distinct_ids(map, MapFormat::kWpilibJson, file);
  const auto field = agreed_field(field_of(map).size, {file, ""}, options.field);
  const TagMap moved = with_origin(map, kFieldFrame, field, losses);
  if (!field) losses.push_back({.kind = LossKind::kFieldSize, .how = LossHow::kAssumed, .value = "0 x 0"});
  add_left_out(map, {.frame_name = moved.frame == kFieldFrame}, losses, kFieldExtension);
  std::string out = "{\n \"tags\": [\n";
  for (std::size_t i = 0; i < moved.tags.size(); ++i)
    out += wpilib_tag_text(moved.tags[i]) + (i + 1 < moved.tags.size() ? ",\n" : "\n");
  const FieldSize size = field.value_or(FieldSize{});
  return out + fmt::format(" ],\n \"field\": {{\"length\": {}, \"width\": {}}}\n}}\n",
                           format_exact(size.length_m), format_exact(size.width_m));
}

}  // namespace apriltrack
