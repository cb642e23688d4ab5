#include <fmt/format.h>

#include <span>

#include "camera_fields.h"

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

Distortion read_lens(const YamlNode& root) {
  check_lens_model(root);
  const auto model = root.find("distortion_model");
  const auto coefficients = find_any(root, kCoefficientNames);
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

}  // namespace

bool has_camera_matrix(const YamlNode& root) {
  return find_any(root, kMatrixNames).has_value();
}

CameraRig read_matrix_camera(const YamlNode& root) {
  const Pinhole pinhole = read_pinhole_matrix(*find_any(root, kMatrixNames));
  Camera camera{.model = CameraModel(pinhole, read_lens(root)), .response_origin = ResponseOrigin::kAssumed};
  const Resolution resolution = read_size(root);
  camera.width = resolution.width;
  camera.height = resolution.height;
  return {{camera}};
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
