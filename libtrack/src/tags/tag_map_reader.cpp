#include <fmt/format.h>

#include <map>

#include "apriltrack/io/yaml_reader.h"
#include "own_map.h"
#include "tag_faults.h"
#include "tag_fields.h"

namespace apriltrack {
namespace {

constexpr int kSchemaVersion = 1;

/// For mappings of which nothing but the known keys survives a round trip.
void expect_only(const YamlNode& node, std::initializer_list<std::string_view> known) {
  node.expect_keys(known);
  for (const auto& [key, value] : node.entries()) {
    if (key.starts_with("x_"))
      value.fail("x_... keys are kept in a file's top level and in a tag only: move it there");
  }
}

std::vector<std::pair<std::string, std::string>> read_extensions(const YamlNode& node) {
  std::vector<std::pair<std::string, std::string>> extensions;
  for (const auto& [key, value] : node.entries()) {
    if (key.starts_with("x_")) extensions.emplace_back(key, value.as_yaml());
  }
  return extensions;
}

Eigen::Vector3d read_position(const YamlNode& node, const TagKey& tag) {
  expect_only(node, {"x", "y", "z"});
  const auto coordinate = [&](std::string_view key) {
    const YamlNode value = node.at(key);
    const double position_m = value.as_double();
    if (const auto fault = fault_of_coordinate(position_m))
      value.fail(fmt::format("of tag {}: {}", to_string(tag), *fault));
    return position_m;
  };
  return {coordinate("x"), coordinate("y"), coordinate("z")};
}

Pose read_pose(const YamlNode& node, const TagKey& tag) {
  expect_only(node, {"position", "orientation"});
  const Eigen::Vector3d translation = read_position(node.at("position"), tag);
  const YamlNode orientation = node.at("orientation");
  expect_only(orientation, {"x", "y", "z", "w"});
  const auto number = [](const YamlNode& from, std::string_view key) { return from.at(key).as_double(); };
  const Eigen::Quaterniond rotation(number(orientation, "w"), number(orientation, "x"),
                                    number(orientation, "y"), number(orientation, "z"));
  if (const auto fault = fault_of_quaternion(rotation)) orientation.fail(*fault);
  return {rotation, translation};
}

Matrix6d read_covariance(const YamlNode& node) {
  const std::vector<double> values = node.as_doubles(36);
  const Matrix6d covariance = Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(values.data());
  if (const auto fault = fault_of_covariance(covariance)) node.fail(*fault);
  return covariance;
}

TagStatistics read_statistics(const YamlNode& node) {
  expect_only(node, {"views", "residual_rms_px", "flags"});
  TagStatistics statistics;
  const YamlNode views = node.at("views");
  statistics.views = views.as_int();
  if (statistics.views < 0) views.fail(fmt::format("must be >= 0 (is {})", statistics.views));
  const YamlNode residual = node.at("residual_rms_px");
  statistics.residual_rms_px = residual.as_double();
  if (statistics.residual_rms_px < 0.0) {
    residual.fail(fmt::format("must be >= 0 (is {})", statistics.residual_rms_px));
  }
  if (const auto flags = node.find("flags")) {
    for (const YamlNode& flag : flags->items()) statistics.flags.push_back(flag.as_string());
  }
  return statistics;
}

TagKey read_key(const YamlNode& node, const std::optional<std::string>& default_family) {
  const auto family = node.find("family");
  if (!family && !default_family) node.fail("has no 'family', and the file has no 'default_family'");
  const YamlNode id = node.at("id");
  const TagKey key{family ? family->as_string() : *default_family, id.as_int()};
  if (family) expect_known_family(*family, key.family);
  expect_id_of_family(id, key);
  return key;
}

MapTag read_tag(const YamlNode& node, const std::optional<std::string>& default_family) {
  node.expect_keys({"id", "family", "size", "pose", "covariance", "statistics"});
  MapTag tag;
  tag.key = read_key(node, default_family);
  tag.size_m = read_tag_size(node.at("size"));
  tag.T_map_tag = read_pose(node.at("pose"), tag.key);
  if (const auto covariance = node.find("covariance")) tag.covariance = read_covariance(*covariance);
  if (const auto statistics = node.find("statistics")) tag.statistics = read_statistics(*statistics);
  tag.extensions = read_extensions(node);
  return tag;
}

std::vector<MapTag> read_tags(const YamlNode& node, const std::optional<std::string>& default_family) {
  std::vector<MapTag> tags;
  std::map<TagKey, std::string> first_places;
  for (const YamlNode& item : node.items()) {
    MapTag tag = read_tag(item, default_family);
    const auto [first, is_new] = first_places.emplace(tag.key, item.where());
    if (!is_new) item.fail(fmt::format("tag {} is already defined at {}", to_string(tag.key), first->second));
    tags.push_back(std::move(tag));
  }
  if (tags.empty()) node.fail("a map needs at least one tag");
  return tags;
}

void expect_schema_version(const YamlNode& root) {
  const auto node = root.find("apriltrack_map");
  if (!node)
    root.fail(fmt::format("'apriltrack_map' is missing: a tag map begins with 'apriltrack_map: {}'",
                          kSchemaVersion));
  const int version = node->as_int();
  if (version != kSchemaVersion) {
    node->fail(fmt::format("this program reads schema version {} (is {})", kSchemaVersion, version));
  }
}

}  // namespace

TagMap own_map_of(const YamlNode& root) {
  expect_schema_version(root);
  root.expect_keys({"apriltrack_map", "frame", "default_family", "provenance", "tags"});
  TagMap map;
  map.frame = root.at("frame").as_string();
  std::optional<std::string> default_family;
  if (const auto node = root.find("default_family")) {
    default_family = node->as_string();
    expect_known_family(*node, *default_family);
    map.default_family = *default_family;
  }
  if (const auto provenance = root.find("provenance")) {
    for (const auto& [key, value] : provenance->entries())
      map.provenance.emplace_back(key, value.as_string());
  }
  map.tags = read_tags(root.at("tags"), default_family);
  map.extensions = read_extensions(root);
  return map;
}

}  // namespace apriltrack
