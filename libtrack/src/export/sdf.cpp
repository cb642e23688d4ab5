// SDFormat 1.9 (Gazebo): one static model, a link for each tag in our tag frame. Poses are x y z roll pitch
// yaw, about standing axes, x first.
#include <fmt/format.h>

#include "apriltrack/geometry/rotation.h"
#include "apriltrack/io/numbers.h"
#include "export_words.h"
#include "tag_boxes.h"
#include "writers.h"

namespace apriltrack {
namespace {

/// Light of its own, too, so that it is black and white where no lamp shines.
std::string sdf_material(bool is_black) {
  const std::string_view light = is_black ? "0 0 0 1" : "1 1 1 1";
  return fmt::format(
      "<material><ambient>{0}</ambient><diffuse>{0}</diffuse><specular>0 0 0 1</specular></material>", light);
}

std::string sdf_visual(const TagBox& box, std::size_t index) {
  return fmt::format(
      "      <visual name=\"v{}\">\n        <pose>{} 0 0 0</pose>\n        "
      "<geometry><box><size>{}</size></box></geometry>\n"
      "        {}\n      </visual>\n",
      index, exact_numbers(box.centre), exact_numbers(box.size), sdf_material(box.is_black));
}

std::string sdf_link(const MapTag& tag) {
  std::string text = fmt::format("    <link name=\"{}\">\n      <pose>{} {}</pose>\n", flat_name(tag.key),
                                 exact_numbers(tag.T_map_tag.translation()),
                                 exact_numbers(roll_pitch_yaw_of(tag.T_map_tag.rotation())));
  const std::vector<TagBox> boxes = boxes_of(tag);
  for (std::size_t i = 0; i < boxes.size(); ++i) text += sdf_visual(boxes[i], i);
  return text + "    </link>\n";
}

}  // namespace

std::string sdf_text(const TagMap& map) {
  const std::string name = plain_frame_name(map);
  std::string out = fmt::format(
      "<?xml version=\"1.0\"?>\n<!-- Tags of frame {0}. Links: x right, y down, z into the tag; metres, "
      "radians. -->\n"
      "<sdf version=\"1.9\">\n  <model name=\"{0}_tags\">\n    <static>true</static>\n",
      name);
  for (const MapTag& tag : map.tags) out += sdf_link(tag);
  return out + "  </model>\n</sdf>\n";
}

}  // namespace apriltrack
