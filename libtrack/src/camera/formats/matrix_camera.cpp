#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <span>

#include "../camera_fields.h"
#include "apriltrack/camera/sensor_window.h"
#include "formats.h"
#include "rectification.h"

namespace apriltrack {
namespace {

using Names = std::span<const std::string_view>;

// camera_matrix: OpenCV, ROS, WPILib. K, k: OpenCV samples, ROS messages. cameraIntrinsics: PhotonVision.
constexpr std::string_view kMatrixNames[] = {"camera_matrix", "Camera_Matrix", "K", "k", "cameraIntrinsics"};
constexpr std::string_view kCoefficientNames[] = {"distortion_coefficients",
                                                  "Distortion_Coefficients",
                                                  "distortion_vector",
                                                  "dist_coeffs",
                                                  "D",
                                                  "d",
                                                  "distCoeffs"};
// PhotonVision/photonvision: photon-core CameraCalibrationCoefficients.java, where "cameraExtrinsics" is an
// alias of distCoeffs: the key that its versions until 2023 wrote. In other files it would be a pose.
constexpr std::string_view kPhotonVisionCoefficientNames[] = {"distCoeffs", "cameraExtrinsics"};
constexpr std::string_view kRectificationNames[] = {"rectification_matrix", "R", "r"};
constexpr std::string_view kProjectionNames[] = {"projection_matrix", "P", "p"};
constexpr std::string_view kWidthNames[] = {"image_width", "image_Width", "width"};
constexpr std::string_view kHeightNames[] = {"image_height", "image_Height", "height"};

/// The value that goes by any of the names; two of them would leave open which is meant.
std::optional<YamlNode> find_any(const YamlNode& root, Names names) {
  std::optional<YamlNode> found;
  for (const std::string_view name : names) {
    const auto value = root.find(name);
    if (!value) continue;
    if (found) value->fail(fmt::format("says the same as '{}'; keep one of them", found->key_path()));
    found = value;
  }
  return found;
}

std::optional<YamlNode> find_coefficients(const YamlNode& root) {
  const bool is_of_photonvision = root.find("cameraIntrinsics").has_value();
  return is_of_photonvision ? find_any(root, kPhotonVisionCoefficientNames)
                            : find_any(root, kCoefficientNames);
}

/// OpenCV's own calibration program notes a fisheye calibration so.
bool is_opencv_fisheye(const YamlNode& root) {
  const auto flag = root.find("fisheye_model");
  return flag && flag->as_int() != 0;
}

/// PhotonVision and mrcal name OpenCV's models so; their others (splined, stereographic) are no OpenCV
/// models.
void check_lens_model(const YamlNode& root) {
  const auto model = root.find("lensmodel");
  if (!model || model->as_string().starts_with("LENSMODEL_OPENCV")) return;
  model->fail(
      fmt::format("'{}' is not supported; supported are LENSMODEL_OPENCV4, 5 and 8", model->as_string()));
}

/// Of which four coefficients alone make sense.
bool is_fisheye_file(const YamlNode& root) {
  const auto model = root.find("distortion_model");
  if (!model || model->is_null()) return is_opencv_fisheye(root);
  const std::string name = model->as_string();
  return name == "equidistant" || name == "equi" || name == "fisheye";
}

Distortion read_lens(const YamlNode& root) {
  const auto model = root.find("distortion_model");
  const auto coefficients = find_coefficients(root);
  const YamlNode* coefficients_or_none = coefficients ? &*coefficients : nullptr;
  if (model) return read_distortion(model->is_null() ? "" : model->as_string(), coefficients_or_none, *model);
  return read_distortion(is_opencv_fisheye(root) ? "fisheye" : "plumb_bob", coefficients_or_none, root);
}

Resolution read_size(const YamlNode& root) {
  if (const auto resolution = root.find("resolution")) {
    if (resolution->is_list()) return read_resolution_list(*resolution);
    return read_resolution(resolution->at("width"), resolution->at("height"));
  }
  const auto width = find_any(root, kWidthNames);
  const auto height = find_any(root, kHeightNames);
  if (width && !height) width->fail("the height is missing (image_height)");
  if (height && !width) height->fail("the width is missing (image_width)");
  return width ? read_resolution(*width, *height) : Resolution{};
}

/// 0 where the file does not say.
int whole_number(const YamlNode& root, std::string_view key) {
  const auto node = root.find(key);
  if (!node) return 0;
  const int value = node->as_int();
  if (value < 0 || value > kMaxResolution)
    node->fail(fmt::format("must lie in [0, {}] pixels (is {})", kMaxResolution, value));
  return value;
}

/// What of the sensor the pictures show that a message of ROS comes with, where it says so; the matrix is of
/// the whole.
SensorWindow read_window(const YamlNode& root) {
  SensorWindow window{.binning_x = std::max(1, whole_number(root, "binning_x")),
                      .binning_y = std::max(1, whole_number(root, "binning_y"))};
  const auto roi = root.find("roi");
  if (!roi || !roi->is_map()) return window;
  window.x_offset = whole_number(*roi, "x_offset");
  window.y_offset = whole_number(*roi, "y_offset");
  window.width = whole_number(*roi, "width");
  window.height = whole_number(*roi, "height");
  return window;
}

bool has_any(const YamlNode& root, std::initializer_list<std::string_view> keys) {
  return std::ranges::any_of(keys, [&](std::string_view key) { return root.find(key).has_value(); });
}

/// Nullopt where there is no camera matrix.
std::optional<CameraFormat> format_of_matrix_camera(const CameraText& file) {
  const YamlNode& root = *file.root;
  if (!find_any(root, kMatrixNames)) return std::nullopt;
  if (root.find("cameraIntrinsics")) return CameraFormat::kPhotonVision;
  if (has_any(root,
              {"rectification_matrix", "projection_matrix", "distortion_model", "binning_x", "header"}) &&
      !file.text.starts_with("%YAML:"))
    return CameraFormat::kRosCameraInfo;
  const auto matrix = root.find("camera_matrix");
  const bool is_of_opencv = !matrix || (matrix->is_map() && matrix->find("type_id"));
  const std::size_t first = file.text.find_first_not_of(" \t\r\n");
  const bool is_json = first != std::string::npos && file.text[first] == '{';
  return is_json && !is_of_opencv ? CameraFormat::kWpilib : CameraFormat::kOpenCv;
}

/// What ROS says beside the lens: the camera's name, or that of its frame, and how its pictures are
/// rectified.
void note_facts_of_ros(const YamlNode& root, const Pinhole& pinhole, std::vector<ConversionLoss>& lost) {
  const auto header = root.find("header");
  auto name = root.find("camera_name");
  if (!name && header && header->is_map()) name = header->find("frame_id");
  if (name && name->is_scalar() && !name->is_null()) note_name(name->as_string(), lost);
  note_rectification(find_any(root, kRectificationNames), find_any(root, kProjectionNames), pinhole, lost);
}

}  // namespace

bool is_ros_camera_info(const CameraText& file) {
  return format_of_matrix_camera(file) == CameraFormat::kRosCameraInfo;
}

bool is_opencv(const CameraText& file) {
  return format_of_matrix_camera(file) == CameraFormat::kOpenCv;
}

bool is_wpilib(const CameraText& file) {
  return format_of_matrix_camera(file) == CameraFormat::kWpilib;
}

bool is_photonvision(const CameraText& file) {
  return format_of_matrix_camera(file) == CameraFormat::kPhotonVision;
}

CameraRig read_matrix_camera(const CameraText& file, CameraReading& reading) {
  const YamlNode& root = *file.root;
  check_lens_model(root);
  const YamlNode matrix = *find_any(root, kMatrixNames);
  const SkewedPinhole lens = read_pinhole_matrix(matrix);
  const auto node = find_coefficients(root);
  const std::vector<double> coefficients =
      node && !is_fisheye_file(root) ? read_matrix_data(*node) : std::vector<double>{};
  Camera camera{.model = has_further_terms(coefficients)
                             ? lens_of_further_terms(lens.pinhole, coefficients, *node, read_size(root),
                                                     reading.beyond, reading.lost)
                             : CameraModel(lens.pinhole, read_lens(root)),
                .response_origin = ResponseOrigin::kAssumed};
  const Resolution size = read_size(root);
  camera.width = size.width;
  camera.height = size.height;
  pass_over_skew(lens.skew_px, camera, matrix, reading.lost);
  if (is_ros_camera_info(file)) note_facts_of_ros(root, lens.pinhole, reading.lost);
  return {{camera_of_window(camera, read_window(root))}};
}

}  // namespace apriltrack
