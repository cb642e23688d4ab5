// Cameras of VINS-Fusion and VINS-Mono: camodocal's YAML (HKUST-Aerial-Robotics/VINS-Fusion,
// camera_models/src/camera_models/PinholeCamera.cc and EquidistantCamera.cc). Its k2 to k5 of KANNALA_BRANDT
// are the coefficients of theta^3 to theta^9, our k1 to k4. Its corners are OpenCV's, and so is its pixel
// (0, 0).

#include <fmt/format.h>

#include "../camera_fields.h"
#include "formats.h"

namespace apriltrack {
namespace {

/// Of PINHOLE, whose four coefficients may all be missing.
CameraModel read_pinhole_of_vins(const YamlNode& root) {
  const YamlNode p = root.at("projection_parameters");
  const Pinhole pinhole = checked_pinhole(p.at("fx").as_double(), p.at("fy").as_double(),
                                          p.at("cx").as_double(), p.at("cy").as_double(), p);
  const auto d = root.find("distortion_parameters");
  if (!d) return {pinhole, NoDistortion()};
  return {pinhole, RadtanDistortion({d->at("k1").as_double(), d->at("k2").as_double(),
                                     d->at("p1").as_double(), d->at("p2").as_double()})};
}

/// Some tools write the coefficients into distortion_parameters, where camodocal does not look for them.
CameraModel read_fisheye_of_vins(const YamlNode& root) {
  const YamlNode p = root.at("projection_parameters");
  const Pinhole pinhole = checked_pinhole(p.at("mu").as_double(), p.at("mv").as_double(),
                                          p.at("u0").as_double(), p.at("v0").as_double(), p);
  const auto apart = root.find("distortion_parameters");
  const YamlNode& d = apart && !p.find("k2") ? *apart : p;
  return {pinhole, EquidistantDistortion({d.at("k2").as_double(), d.at("k3").as_double(),
                                          d.at("k4").as_double(), d.at("k5").as_double()})};
}

CameraModel read_model_of_vins(const YamlNode& root) {
  const YamlNode type = root.at("model_type");
  const std::string name = type.as_string();
  if (name == "PINHOLE") return read_pinhole_of_vins(root);
  if (name == "KANNALA_BRANDT") return read_fisheye_of_vins(root);
  type.fail(
      fmt::format("'{}' is not supported; supported are PINHOLE and KANNALA_BRANDT: calibrate with "
                  "`Calibrations --camera-model kannala-brandt`, which serves wide lenses",
                  name));
}

}  // namespace

bool is_vins(const CameraText& file) {
  return file.root->find("model_type").has_value();
}

CameraRig read_vins(const CameraText& file, CameraReading& reading) {
  const YamlNode& root = *file.root;
  if (const auto name = root.find("camera_name")) note_name(name->as_string(), reading.lost);
  const Resolution size = read_resolution(root.at("image_width"), root.at("image_height"));
  return {{Camera{.model = read_model_of_vins(root),
                  .width = size.width,
                  .height = size.height,
                  .response_origin = ResponseOrigin::kAssumed}}};
}

}  // namespace apriltrack
