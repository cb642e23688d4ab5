// nerfstudio's transforms.json (nerfstudio-project/nerfstudio, docs/quickstart/data_conventions.md). The
// middle of the top-left pixel is (0.5, 0.5) there (nerfstudio/cameras/cameras.py, get_image_coords), as in
// COLMAP, whose numbers its converters copy.

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "../camera_fields.h"
#include "colmap.h"
#include "formats.h"

namespace apriltrack {
namespace {

constexpr std::array<std::string_view, 5> kPerspective = {"OPENCV", "PINHOLE", "SIMPLE_PINHOLE",
                                                          "SIMPLE_RADIAL", "RADIAL"};

double value_or_zero(const YamlNode& root, std::string_view key) {
  const auto value = root.find(key);
  return value ? value->as_double() : 0.0;
}

void refuse_unless_zero(const YamlNode& root, std::string_view key, std::string_view why) {
  if (value_or_zero(root, key) == 0.0) return;
  root.at(key).fail(fmt::format("must be 0 (is {}): {}", root.at(key).as_double(), why));
}

Distortion read_lens_of_nerfstudio(const YamlNode& root) {
  const auto model = root.find("camera_model");
  const std::string name = model ? model->as_string() : "OPENCV";
  const auto k = [&](std::string_view key) { return value_or_zero(root, key); };
  if (name == "OPENCV_FISHEYE") {
    for (const char* key : {"p1", "p2"}) refuse_unless_zero(root, key, "a fisheye has no tangential terms");
    return EquidistantDistortion({k("k1"), k("k2"), k("k3"), k("k4")});
  }
  if (std::ranges::find(kPerspective, name) == kPerspective.end()) {
    model->fail(
        fmt::format("'{}' is not supported; supported are {} and OPENCV_FISHEYE: calibrate with one of them",
                    name, fmt::join(kPerspective, ", ")));
  }
  refuse_unless_zero(root, "k4",
                     "here k4 is a fourth power of the squared radius, which OpenCV's model has not; "
                     "calibrate without it");
  return RadtanDistortion({k("k1"), k("k2"), k("p1"), k("p2"), k("k3")});
}

/// Each frame has the camera's pose, which a camera file of ours has not.
void note_frames(const YamlNode& root, std::vector<ConversionLoss>& lost) {
  const auto frames = root.find("frames");
  if (!frames || !frames->is_list()) return;
  for (const YamlNode& frame : frames->items()) {
    if (!frame.is_map() || !frame.find("transform_matrix")) continue;
    return note_place(frame, "transform_matrix", "cam0", lost);
  }
}

}  // namespace

bool is_nerfstudio(const CameraText& file) {
  const YamlNode& root = *file.root;
  return root.find("fl_x") || root.find("camera_angle_x") ||
         (root.find("frames") && root.find("camera_model"));
}

CameraRig read_nerfstudio(const CameraText& file, CameraReading& reading) {
  const YamlNode& root = *file.root;
  if (!root.find("fl_x"))
    root.fail(
        "'fl_x' is missing at the top level: a file whose frames have cameras of their own, or that tells a "
        "field of view alone (camera_angle_x), is not supported; write fl_x, fl_y, cx, cy, w and h there");
  const Pinhole pinhole = checked_pinhole(root.at("fl_x").as_double(), root.at("fl_y").as_double(),
                                          root.at("cx").as_double() - kColmapPixelOffset_px,
                                          root.at("cy").as_double() - kColmapPixelOffset_px, root);
  const Resolution size = read_resolution(root.at("w"), root.at("h"));
  note_frames(root, reading.lost);
  return {{Camera{.model = CameraModel(pinhole, read_lens_of_nerfstudio(root)),
                  .width = size.width,
                  .height = size.height,
                  .response_origin = ResponseOrigin::kAssumed}}};
}

}  // namespace apriltrack
