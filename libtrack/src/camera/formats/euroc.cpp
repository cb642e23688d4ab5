#include "../camera_fields.h"
#include "formats.h"

namespace apriltrack {

bool is_euroc_sensor(const YamlNode& root) {
  return root.find("intrinsics") && root.find("distortion_model");
}

CameraRig read_euroc_sensor(const YamlNode& root) {
  const Pinhole pinhole = read_pinhole_list(root.at("intrinsics"));
  const YamlNode model = root.at("distortion_model");
  const auto coefficients = root.find("distortion_coefficients");
  Camera camera{
      .model = CameraModel(
          pinhole, read_distortion(model.as_string(), coefficients ? &*coefficients : nullptr, model)),
      .response_origin = ResponseOrigin::kAssumed};
  const Resolution resolution = read_resolution_list(root.at("resolution"));
  camera.width = resolution.width;
  camera.height = resolution.height;
  return {{camera}};
}

}  // namespace apriltrack
