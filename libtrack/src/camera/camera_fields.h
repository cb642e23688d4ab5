#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "apriltrack/camera/camera.h"
#include "apriltrack/io/yaml_reader.h"

namespace apriltrack {

// What the formats of camera files have in common. All throw Error(kInvalidInput) with file, line and key.

/// intrinsics: [fx, fy, cx, cy].
Pinhole read_pinhole_list(const YamlNode& node);
/// A 3x3 matrix fx 0 cx / 0 fy cy / 0 0 1: nine numbers, three lists of three, or a mapping with rows, cols
/// and data.
Pinhole read_pinhole_matrix(const YamlNode& node);

/// A list of numbers, or a mapping with rows, cols and data (OpenCV, ROS, PhotonVision).
std::vector<double> read_matrix_data(const YamlNode& node);

/// model: the lens's name in any of the formats' spellings; "" and "none" for no distortion.
/// coefficients: nullptr when the file has none.  node: what a message about model or missing coefficients
/// points at.
Distortion read_distortion(const std::string& model, const YamlNode* coefficients, const YamlNode& node);

struct Resolution {
  int width = 0;
  int height = 0;
};
Resolution read_resolution(const YamlNode& width, const YamlNode& height);
/// resolution: [width, height].
Resolution read_resolution_list(const YamlNode& node);

/// srgb | linear | gamma:G | path of a table, relative to `folder`.
ResponseCurve read_response(const YamlNode& node, const std::filesystem::path& folder);
/// 256 numbers, apart by blanks, commas or line ends; `#` begins a comment. A table that ends above 1 (0 to
/// 255 is usual) is divided by its last number.
ResponseCurve read_response_table(const std::filesystem::path& path);
std::string format_response_table(const ResponseCurve& response);

// One reader for each family of formats.

/// to_estimate: gets the names of cameras with `response: auto`, which nullptr refuses.
CameraRig read_kalibr_camchain(const YamlNode& root, const std::filesystem::path& folder,
                               std::vector<std::string>* to_estimate);
/// OpenCV FileStorage, ROS camera_info, WPILib and PhotonVision: a camera matrix and OpenCV's coefficients.
CameraRig read_matrix_camera(const YamlNode& root);
bool has_camera_matrix(const YamlNode& root);
CameraRig read_euroc_sensor(const YamlNode& root);

}  // namespace apriltrack
