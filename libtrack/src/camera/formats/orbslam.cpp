// Settings of ORB-SLAM2 and ORB-SLAM3 (UZ-SLAMLab/ORB_SLAM3, src/Settings.cc and, of files without
// File.version, src/Tracking.cc): Camera1.fx and so on since File.version 1.0, Camera.fx before. Its
// undistortion is OpenCV's, and so is its pixel (0, 0).

#include <fmt/format.h>

#include "../camera_fields.h"
#include "formats.h"

namespace apriltrack {
namespace {

/// "Camera1.fx", "Camera.fx", ...
class OrbSlamKeys {
 public:
  OrbSlamKeys(const YamlNode& root, std::string prefix) : root_(root), prefix_(std::move(prefix)) {}
  bool has(const char* key) const { return root_.find(prefix_ + key).has_value(); }
  double at(const char* key) const { return root_.at(prefix_ + key).as_double(); }

 private:
  const YamlNode& root_;
  std::string prefix_;
};

std::string type_of_orbslam(const YamlNode& root) {
  const auto type = root.find("Camera.type");
  return type ? type->as_string() : "PinHole";  // ORB-SLAM2 has no other
}

/// Without k1, a PinHole is not distorted; k3 is OpenCV's fifth coefficient.
Distortion read_lens_of_orbslam(const YamlNode& root, const OrbSlamKeys& keys) {
  const std::string type = type_of_orbslam(root);
  if (type == "KannalaBrandt8")
    return EquidistantDistortion({keys.at("k1"), keys.at("k2"), keys.at("k3"), keys.at("k4")});
  if (type == "Rectified") return NoDistortion();
  if (type != "PinHole")
    root.at("Camera.type")
        .fail(
            fmt::format("'{}' is not supported; supported are PinHole, KannalaBrandt8 and Rectified", type));
  if (!keys.has("k1")) return NoDistortion();
  std::vector<double> k = {keys.at("k1"), keys.at("k2"), keys.at("p1"), keys.at("p2")};
  if (keys.has("k3")) k.push_back(keys.at("k3"));
  return RadtanDistortion(k);
}

Camera read_camera_of_orbslam(const YamlNode& root, const std::string& prefix) {
  const OrbSlamKeys keys(root, prefix);
  Camera camera{
      .model = CameraModel(checked_pinhole(keys.at("fx"), keys.at("fy"), keys.at("cx"), keys.at("cy"), root),
                           read_lens_of_orbslam(root, keys)),
      .response_origin = ResponseOrigin::kAssumed};
  const Resolution size = read_resolution(root.at("Camera.width"), root.at("Camera.height"));
  camera.width = size.width;
  camera.height = size.height;
  return camera;
}

/// Of files without File.version for two cameras: Camera.fx is of the pictures that ORB-SLAM itself makes.
void refuse_rectified_by_orbslam(const YamlNode& root) {
  if (const auto left = root.find("LEFT.K"))
    left->fail(
        "Camera.fx of a file with LEFT.K is of rectified pictures, and not of those that the camera "
        "took: write a file of LEFT.K, LEFT.D, LEFT.width and LEFT.height as OpenCV names them "
        "(camera_matrix, distortion_coefficients, image_width, image_height)");
}

}  // namespace

bool is_orbslam(const CameraText& file) {
  return file.root->find("Camera.fx") || file.root->find("Camera1.fx");
}

CameraRig read_orbslam(const CameraText& file, CameraReading& reading) {
  const YamlNode& root = *file.root;
  refuse_rectified_by_orbslam(root);
  CameraRig rig{{read_camera_of_orbslam(root, root.find("Camera1.fx") ? "Camera1." : "Camera.")}};
  if (root.find("Camera2.fx")) {
    rig.cameras.push_back(read_camera_of_orbslam(root, "Camera2."));
    rig.cameras.back().name = "cam1";
  }
  // Of both cameras: T_c1_c2, Tlr before File.version 1.0; baseline b in metres, bf times fx. Of the first
  // and the IMU: T_b_c1, Tbc before.
  for (const char* key : {"Stereo.T_c1_c2", "Tlr", "Stereo.b", "Camera.bf"})
    note_place(root, key, rig.cameras.back().name, reading.lost);
  for (const char* key : {"IMU.T_b_c1", "Tbc"}) note_place(root, key, rig.cameras.front().name, reading.lost);
  return rig;
}

}  // namespace apriltrack
