// OpenImuCameraCalibrator's JSON (urbste/OpenImuCameraCalibrator, src/io/read_camera_calibration.cc), whose
// lens models are Theia's: fy = focal_length * aspect_ratio, the skew is the matrix's upper middle. Its
// corners are OpenCV's, and so is its pixel (0, 0).

#include <fmt/format.h>

#include "../camera_fields.h"
#include "formats.h"

namespace apriltrack {
namespace {

std::vector<double> values_at(const YamlNode& node, std::initializer_list<const char*> keys) {
  std::vector<double> values;
  for (const char* key : keys) values.push_back(node.at(key).as_double());
  return values;
}

/// type: FISHEYE, ...; node: the intrinsics.
Distortion read_lens_of_theia(const YamlNode& type, const YamlNode& node) {
  const std::string name = type.as_string();
  if (name == "FISHEYE") {
    return EquidistantDistortion(values_at(
        node, {"radial_distortion_1", "radial_distortion_2", "radial_distortion_3", "radial_distortion_4"}));
  }
  if (name == "PINHOLE_RADIAL_TANGENTIAL") {
    return RadtanDistortion(
        values_at(node, {"radial_distortion_1", "radial_distortion_2", "tangential_distortion_1",
                         "tangential_distortion_2", "radial_distortion_3"}));
  }
  if (name == "PINHOLE") return NoDistortion();
  type.fail(
      fmt::format("'{}' is not supported; supported are FISHEYE, PINHOLE_RADIAL_TANGENTIAL and PINHOLE: run "
                  "calibrate_camera with --camera_model_to_calibrate=FISHEYE, which serves wide lenses",
                  name));
}

}  // namespace

bool is_openicc(const CameraText& file) {
  return file.root->find("intrinsic_type") && file.root->find("intrinsics");
}

CameraRig read_openicc(const CameraText& file, CameraReading& reading) {
  const YamlNode& root = *file.root;
  const YamlNode node = root.at("intrinsics");
  const double focal_px = node.at("focal_length").as_double();
  const Pinhole pinhole =
      checked_pinhole(focal_px, focal_px * node.at("aspect_ratio").as_double(),
                      node.at("principal_pt_x").as_double(), node.at("principal_pt_y").as_double(), node);
  Camera camera{.model = CameraModel(pinhole, read_lens_of_theia(root.at("intrinsic_type"), node)),
                .response_origin = ResponseOrigin::kAssumed};
  const Resolution size = read_resolution(root.at("image_width"), root.at("image_height"));
  camera.width = size.width;
  camera.height = size.height;
  if (const auto skew = node.find("skew")) pass_over_skew(skew->as_double(), camera, *skew, reading.lost);
  return {{camera}};
}

}  // namespace apriltrack
