// Parameter files of ROS 2. Bundles as in the ROS 2 port of apriltag_ros (AprilRobotics/apriltag_ros pull
// request 158, config/tags.param.yaml: tag_bundles.bundle_names, <name>.layout.ids, <name>.layout.<id>.{size,
// x, ..., qz}) and as in christianrauch/apriltag_ros pull request 59 (<name>.ids, <name>.<id>.{size,
// transform: [x, y, z, qw, qx, qy, qz]}). christianrauch's own file has tag.ids, tag.frames and tag.sizes: no
// places. Frames as in ROS 1.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "../tag_fields.h"
#include "apriltag_ros.h"
#include "apriltag_ros_pose.h"
#include "apriltrack/base/error.h"
#include "apriltrack/io/numbers.h"
#include "apriltrack/tags/tag_family.h"
#include "bundles.h"
#include "map_words.h"

namespace apriltrack {
namespace {

/// The first node's parameters: "/**", "apriltag", ...
std::optional<YamlNode> ros2_parameters(const YamlNode& root) {
  if (!root.is_map()) return std::nullopt;
  for (const auto& [name, node] : root.entries()) {
    if (!node.is_map()) continue;
    if (const auto parameters = node.find("ros__parameters"); parameters && parameters->is_map())
      return parameters;
  }
  return std::nullopt;
}

/// `family: 36h11` or `tag_family: tag36h11`.
std::optional<std::string> ros2_family(const YamlNode& parameters) {
  auto node = parameters.find("tag_family");
  if (!node) node = parameters.find("family");
  if (!node) return std::nullopt;
  const std::string text = node->as_string();
  const std::string family = text.starts_with("tag") ? text : "tag" + text;
  expect_known_family(*node, family);
  return family;
}

/// Of a `transform` of seven numbers, or of single keys.
Pose ros2_pose(const YamlNode& node) {
  const auto transform = node.find("transform");
  if (!transform) return pose_of_bundle_tag(node);
  const std::vector<double> v = transform->as_doubles(7);
  const std::vector<YamlNode> items = transform->items();
  const Eigen::Vector3d position(read_coordinate(items[0]), read_coordinate(items[1]),
                                 read_coordinate(items[2]));
  return pose_from_frame({read_unit_quaternion(*transform, v[3], v[4], v[5], v[6]), position},
                         rotation_ros_tag());
}

/// A tag that `ids` does not name is none to ROS, too.
void note_unlisted(const YamlNode& layout, const std::vector<YamlNode>& ids,
                   std::vector<std::string>& foreign) {
  for (const auto& entry : layout.entries()) {
    const std::string& key = entry.first;
    const bool is_listed = key == "ids" || std::ranges::any_of(ids, [&](const YamlNode& id) {
                             return id.is_scalar() && id.as_string() == key;
                           });
    if (!is_listed) foreign.push_back(key + " (not in ids)");
  }
}

TagBundle bundle_of_ros2(const std::string& name, const YamlNode& node,
                         const std::optional<std::string>& family, std::vector<std::string>& foreign) {
  const YamlNode layout = node.find("layout").value_or(node);
  TagBundle bundle{name, {}};
  const std::vector<YamlNode> ids = layout.at("ids").items();
  note_unlisted(layout, ids, foreign);
  for (const YamlNode& id : ids) {
    const YamlNode item = layout.at(id.as_string());
    note_foreign_keys(item, {"size", "transform", "x", "y", "z", "qw", "qx", "qy", "qz"}, foreign);
    bundle.tags.push_back({.place = MapPlace::of(id),
                           .id = id.as_int(),
                           .family = family,
                           .size_m = size_of_bundle_tag(item),
                           .T_map_tag = ros2_pose(item)});
  }
  return bundle;
}

/// Of `tag.ids` (christianrauch) and `standalone_tags.tag_names` (AprilRobotics).
std::size_t num_single_tags(const YamlNode& parameters) {
  std::size_t count = 0;
  const auto count_of = [&](std::string_view block, std::string_view key) {
    const auto node = parameters.find(block);
    const auto list = node && node->is_map() ? node->find(key) : std::nullopt;
    if (list && list->is_list()) count += list->items().size();
  };
  count_of("tag", "ids");
  count_of("standalone_tags", "tag_names");
  return count;
}

}  // namespace

bool is_apriltag_ros2(const MapText& text) {
  const auto parameters = text.root ? ros2_parameters(*text.root) : std::nullopt;
  return parameters && (parameters->find("tag_bundles") || parameters->find("standalone_tags") ||
                        parameters->find("tag") || parameters->find("tag_family"));
}

MapReading read_apriltag_ros2(const MapText& text, const MapReadOptions& options) {
  const YamlNode parameters = *ros2_parameters(*text.root);
  const auto family = ros2_family(parameters);
  std::vector<std::string> foreign;
  note_foreign_keys(parameters, {"tag_family", "family", "tag", "standalone_tags", "tag_bundles"}, foreign);
  std::vector<TagBundle> bundles;
  if (const auto node = parameters.find("tag_bundles"); node && node->is_map()) {
    for (const YamlNode& name : node->at("bundle_names").items())
      bundles.push_back(bundle_of_ros2(name.as_string(), node->at(name.as_string()), family, foreign));
  }
  const std::size_t single_tags = num_single_tags(parameters);
  if (bundles.empty()) fail_without_poses(text.file, "apriltag_ros (ROS 2)", single_tags);
  std::vector<ConversionLoss> losses;
  const TagBundle bundle = chosen_bundle(bundles, options, text.file, "bundle", losses);
  if (single_tags > 0)
    losses.push_back({.kind = LossKind::kTags, .value = "standalone tags, which have no place"});
  add_foreign_keys(foreign, losses);
  return map_of(MapFormat::kAprilTagRos2, options, text.file, bundle.name, bundle.tags, std::move(losses));
}

std::string write_apriltag_ros2(const TagMap& map, const MapWriteOptions&, const std::string& file,
                                std::vector<ConversionLoss>& losses) {
  require_distinct_ids(map, MapFormat::kAprilTagRos2, file);
  const std::string name = ros_name(map.frame);
  const std::string& family = map.tags.front().key.family;
  const bool is_one_family =
      std::ranges::all_of(map.tags, [&](const MapTag& tag) { return tag.key.family == family; });
  if (name != map.frame)
    losses.push_back({.kind = LossKind::kFrameName, .how = LossHow::kConverted, .value = name});
  add_left_out(map, {.sizes = true, .families = is_one_family, .frame_name = true}, losses);
  std::string out =
      "# Tag bundle for the ROS 2 port of apriltag_ros (tag_bundles). Metres; T_bundle_tag, tags with y up "
      "and z\n"
      "# out of the face.\n/**:\n  ros__parameters:\n";
  if (is_one_family) out += fmt::format("    tag_family: {}\n", quoted_text(family));
  std::vector<int> ids;
  for (const MapTag& tag : map.tags) ids.push_back(tag.key.id);
  out += fmt::format(
      "    tag_bundles:\n      bundle_names: [\"{0}\"]\n      {0}:\n        layout:\n          ids: [{1}]\n",
      name, fmt::join(ids, ", "));
  for (const MapTag& tag : map.tags)
    out += fmt::format("          {}:\n            size: {}\n            {}\n", tag.key.id,
                       yaml_double(tag.size_m), text_of_bundle_pose(tag.T_map_tag, "\n            "));
  return out;
}

}  // namespace apriltrack
