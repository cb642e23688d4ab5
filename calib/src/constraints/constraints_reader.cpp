#include <fmt/format.h>

#include <string>
#include <utility>

#include "apriltrack/calib/map_constraints.h"
#include "apriltrack/io/numbers.h"
#include "apriltrack/io/yaml_reader.h"
#include "apriltrack/tags/tag_key_fault.h"

namespace apriltrack {
namespace {

constexpr int kConstraintSchema = 1;

/// "7", or "tag36h11/7".
TagKey read_tag_name(const YamlNode& node) {
  const std::string text = node.as_string();
  const auto key = parse_tag_key(text);
  if (!key) node.fail(fmt::format("'{}' is no tag: write ID or family/ID, such as 7 or tag36h11/7", text));
  if (text.find('/') == std::string::npos) return *key;
  if (const auto fault = fault_of_key(*key)) node.fail(*fault);
  return *key;
}

std::vector<TagKey> read_tag_names(const YamlNode& node) {
  std::vector<TagKey> tags;
  for (const YamlNode& item : node.items()) tags.push_back(read_tag_name(item));
  if (tags.empty()) node.fail("names no tag");
  return tags;
}

std::pair<TagKey, TagKey> read_two_tags(const YamlNode& item) {
  const YamlNode node = item.at("tags");
  const std::vector<TagKey> tags = read_tag_names(node);
  if (tags.size() != 2) node.fail(fmt::format("must name two tags (names {})", tags.size()));
  return {tags[0], tags[1]};
}

/// Coordinates left out stay empty.
std::array<std::optional<double>, 3> read_coordinates(const YamlNode& node) {
  node.expect_keys({"x", "y", "z"});
  std::array<std::optional<double>, 3> result;
  const std::array<std::string_view, 3> names = {"x", "y", "z"};
  for (std::size_t i = 0; i < 3; ++i) {
    if (const auto value = node.find(names[i])) result[i] = value->as_double();
  }
  return result;
}

Eigen::Vector3d read_vector(const YamlNode& node) {
  node.expect_keys({"x", "y", "z"});
  return {node.at("x").as_double(), node.at("y").as_double(), node.at("z").as_double()};
}

Eigen::Quaterniond read_orientation(const YamlNode& node) {
  node.expect_keys({"x", "y", "z", "w"});
  return {node.at("w").as_double(), node.at("x").as_double(), node.at("y").as_double(),
          node.at("z").as_double()};
}

std::optional<double> read_sigma_rad(const YamlNode& item) {
  const auto node = item.find("sigma_rad");
  return node ? std::optional(node->as_double()) : std::nullopt;
}

std::vector<MapConstraint::What> read_position(const YamlNode& item) {
  item.expect_keys({"type", "name", "tag", "position_m", "sigma_m"});
  return {PositionConstraint{read_tag_name(item.at("tag")), read_coordinates(item.at("position_m")),
                             item.at("sigma_m").as_double()}};
}

std::vector<MapConstraint::What> read_distance(const YamlNode& item) {
  item.expect_keys({"type", "name", "tags", "distance_m", "sigma_m"});
  const auto [a, b] = read_two_tags(item);
  return {DistanceConstraint{a, b, item.at("distance_m").as_double(), item.at("sigma_m").as_double()}};
}

std::vector<MapConstraint::What> read_relative_pose(const YamlNode& item) {
  item.expect_keys({"type", "name", "tags", "position_m", "orientation", "sigma_m", "sigma_rad"});
  const auto [a, b] = read_two_tags(item);
  RelativePoseConstraint result{a,
                                b,
                                read_vector(item.at("position_m")),
                                std::nullopt,
                                item.at("sigma_m").as_double(),
                                read_sigma_rad(item)};
  if (const auto node = item.find("orientation")) result.orientation = read_orientation(*node);
  return {result};
}

std::vector<MapConstraint::What> read_coplanar(const YamlNode& item) {
  item.expect_keys({"type", "name", "tags", "sigma_m", "sigma_rad"});
  return {CoplanarConstraint{read_tag_names(item.at("tags")), item.at("sigma_m").as_double(),
                             read_sigma_rad(item)}};
}

std::vector<MapConstraint::What> read_upright(const YamlNode& item) {
  item.expect_keys({"type", "name", "tags", "sigma_rad"});
  std::vector<MapConstraint::What> result;
  for (const TagKey& tag : read_tag_names(item.at("tags")))
    result.emplace_back(UprightConstraint{tag, item.at("sigma_rad").as_double()});
  return result;
}

std::vector<MapConstraint::What> read_floor(const YamlNode& item) {
  item.expect_keys({"type", "name", "tags", "sigma_m", "sigma_rad"});
  std::vector<MapConstraint::What> result;
  for (const TagKey& tag : read_tag_names(item.at("tags")))
    result.emplace_back(FloorConstraint{tag, item.at("sigma_m").as_double(), read_sigma_rad(item)});
  return result;
}

std::vector<MapConstraint::What> read_gravity(const YamlNode& item) {
  if (item.find("camera")) {
    item.expect_keys({"type", "name", "camera", "timestamp_ns", "direction", "sigma_rad"});
    const YamlNode time = item.at("timestamp_ns");
    const auto nanoseconds = parse_integer(time.as_string());
    if (!nanoseconds) time.fail(fmt::format("must be a whole number of ns (is '{}')", time.as_string()));
    return {CameraGravityConstraint{item.at("camera").as_string(),
                                    {*nanoseconds},
                                    read_vector(item.at("direction")),
                                    item.at("sigma_rad").as_double()}};
  }
  item.expect_keys({"type", "name", "tag", "direction", "sigma_rad"});
  return {GravityConstraint{read_tag_name(item.at("tag")), read_vector(item.at("direction")),
                            item.at("sigma_rad").as_double()}};
}

std::vector<MapConstraint::What> read_what(const YamlNode& item) {
  const YamlNode type = item.at("type");
  const std::string name = type.as_string();
  if (name == "position") return read_position(item);
  if (name == "distance") return read_distance(item);
  if (name == "relative_pose") return read_relative_pose(item);
  if (name == "coplanar") return read_coplanar(item);
  if (name == "upright") return read_upright(item);
  if (name == "floor") return read_floor(item);
  if (name == "gravity") return read_gravity(item);
  type.fail(
      fmt::format("must be position, distance, relative_pose, coplanar, upright, floor or gravity (is "
                  "'{}')",
                  name));
}

void read_constraint(const YamlNode& item, std::vector<MapConstraint>& constraints) {
  const std::vector<MapConstraint::What> several = read_what(item);
  for (const MapConstraint::What& what : several) {
    MapConstraint constraint{.what = what, .where = item.where()};
    const std::string title = title_of(constraint);
    if (const auto name = item.find("name"))
      constraint.name =
          several.size() == 1 ? name->as_string() : fmt::format("{} ({})", name->as_string(), title);
    check_constraint(constraint);
    constraints.push_back(std::move(constraint));
  }
}

}  // namespace

std::vector<MapConstraint> read_map_constraints(const std::filesystem::path& path) {
  const YamlNode root = YamlNode::read_file(path);
  const auto version = root.find("apriltrack_constraints");
  if (!version)
    root.fail(
        fmt::format("'apriltrack_constraints' is missing: a constraint file begins with "
                    "'apriltrack_constraints: {}'",
                    kConstraintSchema));
  if (version->as_int() != kConstraintSchema)
    version->fail(
        fmt::format("this program reads schema version {} (is {})", kConstraintSchema, version->as_int()));
  root.expect_keys({"apriltrack_constraints", "constraints"});
  std::vector<MapConstraint> constraints;
  for (const YamlNode& item : root.at("constraints").items()) read_constraint(item, constraints);
  if (constraints.empty()) root.at("constraints").fail("names no constraint");
  return constraints;
}

}  // namespace apriltrack
