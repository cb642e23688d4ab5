// Basalt's calibration.json (VladyslavUsenko/basalt-headers, include/basalt/calibration/calibration.hpp and
// include/basalt/serialization/headers_serialization.h; the lenses: include/basalt/camera). T_imu_cam takes
// points of the camera to the IMU's frame. A pixel's centre is whole there.

#include <fmt/format.h>

#include "../camera_fields.h"
#include "apriltrack/geometry/rounded_rotation.h"
#include "formats.h"

namespace apriltrack {
namespace {

std::vector<double> values_of_basalt(const YamlNode& node, std::initializer_list<const char*> keys) {
  std::vector<double> values;
  for (const char* key : keys) values.push_back(node.at(key).as_double());
  return values;
}

/// camera: camera_type, and intrinsics by their names. rpmax of pinhole-radtan8, where Basalt's lens ends, is
/// passed over, for ours finds its own end.
CameraModel read_model_of_basalt(const YamlNode& camera) {
  const YamlNode type = camera.at("camera_type"), node = camera.at("intrinsics");
  const std::string name = type.as_string();
  if (name != "pinhole" && name != "kb4" && name != "pinhole-radtan8")
    type.fail(
        fmt::format("'{}' is not supported; supported are pinhole, kb4 and pinhole-radtan8: calibrate with "
                    "--cam-types kb4, which serves wide lenses",
                    name));
  const Pinhole pinhole = checked_pinhole(node.at("fx").as_double(), node.at("fy").as_double(),
                                          node.at("cx").as_double(), node.at("cy").as_double(), node);
  if (name == "pinhole") return {pinhole, NoDistortion()};
  if (name == "kb4")
    return {pinhole, EquidistantDistortion(values_of_basalt(node, {"k1", "k2", "k3", "k4"}))};
  return {pinhole,
          RadtanDistortion(values_of_basalt(node, {"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"}))};
}

Pose read_pose_of_basalt(const YamlNode& node) {
  constexpr double kMostLengthError = 1e-3;
  const std::vector<double> p = values_of_basalt(node, {"px", "py", "pz"}),
                            q = values_of_basalt(node, {"qw", "qx", "qy", "qz"});
  const Eigen::Quaterniond rotation(q[0], q[1], q[2], q[3]);
  if (!is_rounded_rotation(rotation, kMostLengthError))
    node.fail(fmt::format("length of the quaternion must be 1 (is {:.4g})", rotation.norm()));
  return {rotation.normalized(), Eigen::Vector3d(p[0], p[1], p[2])};
}

/// As many as there are cameras; one camera may be without a place.
std::vector<Pose> read_places_of_basalt(const YamlNode& root, std::size_t count) {
  std::vector<Pose> places;
  if (const auto list = root.find("T_imu_cam"))
    for (const YamlNode& node : list->items()) places.push_back(read_pose_of_basalt(node));
  if (places.size() != count && (count > 1 || !places.empty()))
    root.fail(fmt::format("T_imu_cam must have as many places as there are cameras, {} (has {})", count,
                          places.size()));
  return places;
}

}  // namespace

bool is_basalt(const CameraText& file) {
  const auto value = file.root->find("value0");
  return value && value->is_map() && value->find("intrinsics");
}

CameraRig read_basalt(const CameraText& file, CameraReading& reading) {
  const YamlNode value = file.root->at("value0");
  const std::vector<YamlNode> cameras = value.at("intrinsics").items();
  const std::vector<YamlNode> sizes = value.at("resolution").items();
  if (cameras.empty()) value.at("intrinsics").fail("has no camera");
  if (sizes.size() != cameras.size())
    value.at("resolution")
        .fail(fmt::format("must have a size for each of the {} cameras (has {})", cameras.size(),
                          sizes.size()));
  const std::vector<Pose> T_imu_cam = read_places_of_basalt(value, cameras.size());
  CameraRig rig;
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const Resolution size = read_resolution_list(sizes[i]);
    Camera camera{.name = fmt::format("cam{}", i),
                  .model = read_model_of_basalt(cameras[i]),
                  .width = size.width,
                  .height = size.height,
                  .response_origin = ResponseOrigin::kAssumed};
    if (i > 0) camera.T_this_previous = T_imu_cam[i].inverse() * T_imu_cam[i - 1];
    rig.cameras.push_back(camera);
  }
  const std::string& first = rig.cameras.front().name;
  if (!T_imu_cam.empty()) note_place(value, "T_imu_cam", first, reading.lost);
  if (const auto offset = value.find("cam_time_offset_ns"); offset && offset->as_double() != 0.0)
    note_place(value, "cam_time_offset_ns", first, reading.lost);
  return rig;
}

}  // namespace apriltrack
