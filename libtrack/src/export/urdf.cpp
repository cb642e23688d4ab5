// URDF: a link for each tag, fixed to a link that is the map's frame. A link's frame is our tag frame: x
// right, y down, z into the tag. rpy of URDF turns about standing axes, x first.
#include <fmt/format.h>

#include "apriltrack/geometry/rotation.h"
#include "apriltrack/io/numbers.h"
#include "export_words.h"
#include "tag_boxes.h"
#include "writers.h"

namespace apriltrack {
namespace {

std::string urdf_visual(const TagBox& box) {
  return fmt::format(
      "    <visual>\n      <origin xyz=\"{}\" rpy=\"0 0 0\"/>\n      <geometry><box "
      "size=\"{}\"/></geometry>\n"
      "      <material name=\"{}\"/>\n    </visual>\n",
      exact_numbers(box.centre), exact_numbers(box.size), box.is_black ? "tag_black" : "tag_white");
}

std::string urdf_tag(const MapTag& tag, const std::string& root) {
  const std::string name = flat_name(tag.key);
  std::string text = fmt::format("  <link name=\"{}\">\n", name);
  for (const TagBox& box : boxes_of(tag)) text += urdf_visual(box);
  return text +
         fmt::format(
             "  </link>\n  <joint name=\"{0}_joint\" type=\"fixed\">\n    <parent link=\"{1}\"/>\n    <child "
             "link=\"{0}\"/>\n    <origin xyz=\"{2}\" rpy=\"{3}\"/>\n  </joint>\n",
             name, root, exact_numbers(tag.T_map_tag.translation()),
             exact_numbers(roll_pitch_yaw_of(tag.T_map_tag.rotation())));
}

}  // namespace

std::string urdf_text(const TagMap& map) {
  const std::string root = plain_frame_name(map);
  std::string out = fmt::format(
      "<?xml version=\"1.0\"?>\n<!-- Tags of frame {}. Links: x right, y down, z into the tag; metres, "
      "radians. -->\n"
      "<robot name=\"{}_tags\">\n  <material name=\"tag_black\"><color rgba=\"0 0 0 1\"/></material>\n"
      "  <material name=\"tag_white\"><color rgba=\"1 1 1 1\"/></material>\n  <link name=\"{}\"/>\n",
      root, root, root);
  for (const MapTag& tag : map.tags) out += urdf_tag(tag, root);
  return out + "</robot>\n";
}

}  // namespace apriltrack
