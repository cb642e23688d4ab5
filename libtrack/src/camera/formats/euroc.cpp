#include "../camera_fields.h"
#include "formats.h"

namespace apriltrack {

bool is_euroc_sensor(const CameraText& file) {
  return file.root->find("intrinsics") && file.root->find("distortion_model");
}

// T_BS takes points of the camera to the body's frame (ASL data set format, sensor.yaml).
CameraRig read_euroc_sensor(const CameraText& file, CameraReading& reading) {
  const YamlNode& root = *file.root;
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
  note_place(root, "T_BS", camera.name, reading.lost);
  return {{camera}};
}

}  // namespace apriltrack
