#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "apriltrack/camera/camera.h"
#include "apriltrack/camera/camera_formats.h"
#include "apriltrack/io/yaml_reader.h"

namespace apriltrack {

// What the formats of camera files have in common. All throw Error(kInvalidInput) with file, line and key.

/// intrinsics: [fx, fy, cx, cy].
Pinhole read_pinhole_list(const YamlNode& node);
struct SkewedPinhole {
  Pinhole pinhole;
  double skew_px = 0.0;
};
/// A 3x3 matrix fx skew cx / 0 fy cy / 0 0 1: nine numbers, three lists of three, or a mapping with rows,
/// cols and data.
SkewedPinhole read_pinhole_matrix(const YamlNode& node);
/// Fails at `node` where a focal length is not > 0.
Pinhole checked_pinhole(double fx, double fy, double cx, double cy, const YamlNode& node);

/// A list of numbers, or a mapping with rows, cols and data (OpenCV, ROS, PhotonVision).
std::vector<double> read_matrix_data(const YamlNode& node);
/// The same, or a list of rows of one length.
std::vector<double> read_matrix_values(const YamlNode& node);

/// OpenCV's list goes on after k6 with s1..s4 (thin prism) and tau_x, tau_y (tilted sensor), 12 or 14 in all:
/// the first eight, where the others are zero; fails where they are not.
std::vector<double> without_zero_tail(std::vector<double> values, const YamlNode& node);

/// model: the lens's name in any of the formats' spellings; "" and "none" for no distortion.
/// coefficients: nullptr when the file has none.  node: what a message about model or missing coefficients
/// points at.
Distortion read_distortion(const std::string& model, const YamlNode* coefficients, const YamlNode& node);

inline constexpr int kMaxResolution = 100'000;

struct Resolution {
  int width = 0;
  int height = 0;
};
Resolution read_resolution(const YamlNode& width, const YamlNode& height);
/// resolution: [width, height].
Resolution read_resolution_list(const YamlNode& node);

/// Throws Error(kInvalidInput) that names the file to write and the way out where a camera has no resolution.
void require_resolution(const Camera& camera, const std::filesystem::path& path);

/// What is wrong with a camera's name ("must not ..."): it stands in CSV files and in NAME=PATH.
std::optional<std::string> fault_of_camera_name(std::string_view name);

/// srgb | linear | gamma:G | path of a table, relative to `folder`.
ResponseCurve read_response(const YamlNode& node, const std::filesystem::path& folder);
/// 256 numbers, apart by blanks, commas or line ends; `#` begins a comment. A table that ends above 1 (0 to
/// 255 is usual) is divided by its last number.
ResponseCurve read_response_table(const std::filesystem::path& path);
std::string format_response_table(const ResponseCurve& response);

/// to_estimate: gets the names of cameras with `response: auto`, which nullptr refuses. lost: gets what is
/// passed over.
CameraRig read_kalibr_camchain(const YamlNode& root, const std::filesystem::path& folder,
                               std::vector<std::string>* to_estimate, std::vector<ConversionLoss>& lost);

}  // namespace apriltrack
