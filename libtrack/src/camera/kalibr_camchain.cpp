#include <fmt/format.h>

#include <algorithm>

#include "apriltrack/geometry/rounded_rotation.h"
#include "apriltrack/image/exposure.h"
#include "camera_fields.h"

namespace apriltrack {
namespace {

/// Kalibr prints 16 digits, hand-written files a few: what a rotation may be off by.
constexpr double kMaxRotationDefect = 1e-3;
/// 30 us are usual; a sensor read upwards has a negative one.
constexpr double kMaxLineDelay_s = 1e-3;

Eigen::Matrix4d read_matrix4(const YamlNode& node) {
  const auto rows = node.items();
  if (rows.size() != 4)
    node.fail(fmt::format("must be a 4x4 matrix, 4 lists of 4 numbers (has {} rows)", rows.size()));
  Eigen::Matrix4d matrix;
  for (int r = 0; r < 4; ++r) {
    const std::vector<double> row = rows[static_cast<std::size_t>(r)].as_doubles(4);
    matrix.row(r) = Eigen::RowVector4d::Map(row.data());
  }
  return matrix;
}

Pose read_rigid_transform(const YamlNode& node) {
  const Eigen::Matrix4d matrix = read_matrix4(node);
  if (matrix.row(3) != Eigen::RowVector4d(0, 0, 0, 1)) {
    const bool is_transposed = matrix.col(3) == Eigen::Vector4d(0, 0, 0, 1);
    node.fail(fmt::format("the last row must be 0 0 0 1{}",
                          is_transposed ? "; the last column is: the matrix seems to be transposed" : ""));
  }
  const Eigen::Matrix3d linear = matrix.topLeftCorner<3, 3>();
  if (const auto rotation = rounded_rotation(linear, kMaxRotationDefect))
    return Pose(*rotation, matrix.topRightCorner<3, 1>());
  const double defect = rotation_defect(linear);
  if (defect <= kMaxRotationDefect)
    node.fail("its upper left 3x3 block is a reflection (determinant -1), no rotation");
  node.fail(fmt::format(
      "its upper left 3x3 block must be a rotation: R R^T is off the identity by {:.3g}, allowed is {}",
      defect, kMaxRotationDefect));
}

void check_camera_model(const YamlNode& node) {
  const std::string name = node.as_string();
  if (name == "pinhole") return;
  node.fail(fmt::format(
      "'{}' is not supported; supported is pinhole, with distortion_model none, radtan or equidistant "
      "(which serves fisheyes up to and beyond 180 degrees): calibrate with pinhole-radtan or "
      "pinhole-equi",
      name));
}

double read_exposure(const YamlNode& node) {
  const double exposure_s = node.as_double();
  if (const auto fault = fault_of_exposure(exposure_s)) node.fail(*fault);
  return exposure_s;
}

double read_line_delay(const YamlNode& node) {
  const double line_delay_s = node.as_double();
  if (std::abs(line_delay_s) > kMaxLineDelay_s) {
    node.fail(fmt::format("must lie in [-{0}, {0}] seconds per row (is {1})", kMaxLineDelay_s, line_delay_s));
  }
  return line_delay_s;
}

/// The key in the file (cam0), unless a label names the camera; no two cameras of `rig` have one name.
std::string read_name(const std::string& key, const YamlNode& node, const CameraRig& rig) {
  const auto label = node.find("label");
  const std::string name = label ? label->as_string() : key;
  if (const auto fault = fault_of_camera_name(name)) label->fail(*fault);
  for (const Camera& other : rig.cameras) {
    if (other.name == name) (label ? *label : node).fail(fmt::format("two cameras are called '{}'", name));
  }
  return name;
}

/// Keys of other programs, and of the file's owner: of a camera, or, of the whole file, told of the first
/// one.
void note_foreign_keys(const std::string& name, const YamlNode& node, std::vector<ConversionLoss>& lost) {
  std::string keys;
  for (const auto& entry : node.entries()) {
    const std::string& key = entry.first;
    if (key.starts_with("x_") || key == "rostopic" || key == "cam_overlaps" || key == "tagtopic" ||
        key == "rig_body")
      keys += (keys.empty() ? "" : ", ") + key;
  }
  if (!keys.empty()) lost.push_back({.kind = LossKind::kCameraKeys, .which = {name}, .value = keys});
}

void note_place_at_imu(const std::string& name, const YamlNode& node, std::vector<ConversionLoss>& lost) {
  for (const char* key : {"T_cam_imu", "T_imu_cam", "timeshift_cam_imu"}) {
    if (!node.find(key)) continue;
    lost.push_back({.kind = LossKind::kExtrinsics, .which = {name}, .value = key});
  }
}

Camera read_camera(const std::string& name, const YamlNode& node, const std::filesystem::path& folder,
                   std::vector<std::string>* to_estimate) {
  // T_imu_cam is OpenVINS's inverse of T_cam_imu; tagtopic and rig_body are TagSLAM's.
  node.expect_keys({"camera_model", "intrinsics", "distortion_model", "distortion_coeffs", "resolution",
                    "exposure_time", "line_delay", "response", "label", "T_cn_cnm1", "rostopic",
                    "cam_overlaps", "T_cam_imu", "T_imu_cam", "timeshift_cam_imu", "tagtopic", "rig_body"});
  check_camera_model(node.at("camera_model"));
  const Pinhole pinhole = read_pinhole_list(node.at("intrinsics"));
  const YamlNode model = node.at("distortion_model");
  const auto coefficients = node.find("distortion_coeffs");
  const Distortion lens = read_distortion(model.as_string(), coefficients ? &*coefficients : nullptr, model);
  Camera camera{.name = name, .model = CameraModel(pinhole, lens)};
  const Resolution resolution = read_resolution_list(node.at("resolution"));
  camera.width = resolution.width;
  camera.height = resolution.height;
  if (const auto value = node.find("exposure_time")) camera.exposure_s = read_exposure(*value);
  if (const auto value = node.find("line_delay")) camera.line_delay_s = read_line_delay(*value);
  const auto response = node.find("response");
  const bool is_to_be_estimated = to_estimate && response && response->as_string() == "auto";
  if (is_to_be_estimated) to_estimate->push_back(name);
  if (!response || is_to_be_estimated)
    camera.response_origin = ResponseOrigin::kAssumed;
  else
    camera.response = read_response(*response, folder);
  if (const auto value = node.find("T_cn_cnm1")) camera.T_this_previous = read_rigid_transform(*value);
  return camera;
}

}  // namespace

CameraRig read_kalibr_camchain(const YamlNode& root, const std::filesystem::path& folder,
                               std::vector<std::string>* to_estimate, std::vector<ConversionLoss>& lost) {
  CameraRig rig;
  for (const auto& [key, node] : root.entries()) {
    if (key.starts_with("x_")) continue;
    const std::string expected = fmt::format("cam{}", rig.cameras.size());
    if (key != expected) {
      node.fail(fmt::format(
          "expected '{}' here: a camera file lists cam0, cam1, ... in this order, and x_... for your "
          "own",
          expected));
    }
    rig.cameras.push_back(read_camera(read_name(key, node, rig), node, folder, to_estimate));
    note_place_at_imu(rig.cameras.back().name, node, lost);
    note_foreign_keys(rig.cameras.back().name, node, lost);
    if (rig.cameras.size() == 1 && rig.cameras[0].T_this_previous) {
      node.at("T_cn_cnm1").fail("the first camera has none before it; remove this key");
    }
  }
  if (!rig.cameras.empty()) note_foreign_keys(rig.cameras.front().name, root, lost);
  return rig;
}

}  // namespace apriltrack
