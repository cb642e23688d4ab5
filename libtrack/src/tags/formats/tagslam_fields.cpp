#include "tagslam_fields.h"

#include <fmt/format.h>

#include <array>

#include "apriltrack/geometry/rotation.h"

namespace apriltrack {
namespace {

constexpr std::array<std::pair<int, std::string_view>, 3> kBitsOfFamilies = {
    {{6, "tag36h11"}, {5, "tag25h9"}, {4, "tag16h5"}}};

Eigen::Vector3d tagslam_vector(const YamlNode& node) {
  return {node.at("x").as_double(), node.at("y").as_double(), node.at("z").as_double()};
}

}  // namespace

std::optional<Pose> tagslam_pose(const YamlNode& node) {
  auto position = node.find("position");
  auto rotation = node.find("rotation");
  if (!position) position = node.find("center");
  if (!rotation) rotation = node.find("rotvec");
  if (!position && !rotation) return std::nullopt;
  if (!position || !rotation) node.fail("must have both position and rotation");
  for (const char* key : {"x", "y", "z"}) read_coordinate(position->at(key));
  const Eigen::Vector3d rotation_vector = tagslam_vector(*rotation);
  if (!(rotation_vector.norm() < 100.0)) rotation->fail("must be a rotation vector in radians");
  return Pose(rotation_exp(rotation_vector), tagslam_vector(*position));
}

std::string family_of_bits(const YamlNode& bits) {
  const int number = bits.as_int();
  for (const auto& [known, family] : kBitsOfFamilies) {
    if (known == number) return std::string(family);
  }
  bits.fail(fmt::format("must be 6 (tag36h11), 5 (tag25h9) or 4 (tag16h5) (is {})", number));
}

std::optional<int> bits_of_family(std::string_view family) {
  for (const auto& [bits, known] : kBitsOfFamilies) {
    if (known == family) return bits;
  }
  return std::nullopt;
}

}  // namespace apriltrack
