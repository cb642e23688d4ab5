// apriltag_ros of ROS 1: config/tags.yaml of AprilRobotics/apriltag_ros, `standalone_tags` (id and size, no
// place) and `tag_bundles` (T_bundle_tag of each tag). The tag's frame has y up and z out of the face: its
// pose is solved from the corners (-s, -s), (s, -s), (s, s), (-s, s) (src/common_functions.cpp there).
#include "apriltag_ros.h"

#include <fmt/format.h>

#include "../tag_fields.h"
#include "apriltag_ros_pose.h"
#include "apriltrack/base/error.h"
#include "apriltrack/io/numbers.h"
#include "bundles.h"
#include "map_words.h"

namespace apriltrack {
namespace {

TagBundle bundle_of_ros1(const YamlNode& node, std::size_t index, std::vector<std::string>& foreign) {
  note_foreign_keys(node, {"name", "layout"}, foreign);
  const auto name = node.find("name");
  TagBundle bundle{name ? name->as_string() : fmt::format("bundle_{}", index), {}};
  for (const YamlNode& item : node.at("layout").items()) {
    note_foreign_keys(item, {"id", "size", "x", "y", "z", "qw", "qx", "qy", "qz"}, foreign);
    bundle.tags.push_back({.place = MapPlace::of(item),
                           .id = item.at("id").as_int(),
                           .size_m = size_of_bundle_tag(item),
                           .T_map_tag = pose_of_bundle_tag(item)});
  }
  return bundle;
}

/// Ids and names of `standalone_tags`; the list may be empty or missing.
std::vector<std::string> single_tags_of_ros1(const YamlNode& root) {
  std::vector<std::string> names;
  const auto list = root.find("standalone_tags");
  if (!list || list->is_null()) return names;
  for (const YamlNode& item : list->items()) names.push_back(item.at("id").as_string());
  return names;
}

}  // namespace

double size_of_bundle_tag(const YamlNode& node) {
  return read_tag_size(node.at("size"));
}

Pose pose_of_bundle_tag(const YamlNode& node) {
  const auto coordinate = [&](std::string_view key) {
    const auto value = node.find(key);
    return value ? read_coordinate(*value) : 0.0;
  };
  const auto number = [&](std::string_view key, double preset) {
    const auto value = node.find(key);
    return value ? value->as_double() : preset;
  };
  const Eigen::Quaterniond rotation =
      read_unit_quaternion(node, number("qw", 1.0), number("qx", 0.0), number("qy", 0.0), number("qz", 0.0));
  return pose_from_frame({rotation, {coordinate("x"), coordinate("y"), coordinate("z")}}, rotation_ros_tag());
}

std::string text_of_bundle_pose(const Pose& T_map_tag, const std::string& between) {
  const Pose pose = pose_to_frame(T_map_tag, rotation_ros_tag());
  const Eigen::Vector3d& p = pose.translation();
  const Eigen::Quaterniond& q = pose.rotation();
  const std::pair<const char*, double> numbers[] = {{"x", p.x()},  {"y", p.y()},  {"z", p.z()}, {"qw", q.w()},
                                                    {"qx", q.x()}, {"qy", q.y()}, {"qz", q.z()}};
  std::string text;
  for (const auto& [key, value] : numbers)
    text += fmt::format("{}{}: {}", text.empty() ? "" : between, key, yaml_double(value));
  return text;
}

void fail_without_poses(const std::string& file, const std::string& project, std::size_t tags) {
  throw invalid_input(file,
                      fmt::format("this file of {} has sizes and names of {} single tag{}, and no bundle: it "
                                  "tells no tag's place, so it is no layout. Film the tags and calibrate "
                                  "(apriltrack calibrate --tag-size, or --tag-sizes with these sizes)",
                                  project, tags, tags == 1 ? "" : "s"));
}

bool is_apriltag_ros(const MapText& text) {
  return text.root && text.root->is_map() &&
         (text.root->find("tag_bundles") || text.root->find("standalone_tags"));
}

MapReading read_apriltag_ros(const MapText& text, const MapReadOptions& options) {
  const YamlNode& root = *text.root;
  std::vector<std::string> foreign;
  note_foreign_keys(root, {"standalone_tags", "tag_bundles"}, foreign);
  const std::vector<std::string> single_tags = single_tags_of_ros1(root);
  std::vector<TagBundle> bundles;
  const auto list = root.find("tag_bundles");
  if (list && !list->is_null()) {
    for (const YamlNode& item : list->items())
      bundles.push_back(bundle_of_ros1(item, bundles.size(), foreign));
  }
  if (bundles.empty()) fail_without_poses(text.file, "apriltag_ros", single_tags.size());
  std::vector<ConversionLoss> losses;
  const TagBundle bundle = chosen_bundle(bundles, options, text.file, "bundle", losses);
  if (!single_tags.empty())
    losses.push_back({.kind = LossKind::kTags, .value = "standalone_tags, which have no place"});
  add_foreign_keys(foreign, losses);
  return map_of(MapFormat::kAprilTagRos, options, text.file, bundle.name, bundle.tags, std::move(losses));
}

std::string write_apriltag_ros(const TagMap& map, const MapWriteOptions&, const std::string& file,
                               std::vector<ConversionLoss>& losses) {
  require_distinct_ids(map, MapFormat::kAprilTagRos, file);
  add_left_out(map, {.sizes = true, .frame_name = true}, losses);
  std::string out = fmt::format(
      "# Tag bundle for apriltag_ros (ROS 1). Metres; T_bundle_tag, tags with y up and z out of the face.\n"
      "standalone_tags: []\ntag_bundles:\n  [\n    {{\n      name: {},\n      layout:\n        [\n",
      quoted_text(map.frame));
  for (std::size_t i = 0; i < map.tags.size(); ++i)
    out += fmt::format("          {{id: {}, size: {}, {}}}{}\n", map.tags[i].key.id,
                       yaml_double(map.tags[i].size_m), text_of_bundle_pose(map.tags[i].T_map_tag, ", "),
                       i + 1 < map.tags.size() ? "," : "");
  return out + "        ]\n    }\n  ]\n";
}

}  // namespace apriltrack
