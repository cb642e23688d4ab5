#include <fmt/format.h>

#include "writers.h"

namespace apriltrack {
namespace {

bool is_fisheye(const Camera& camera) {
  return std::holds_alternative<EquidistantDistortion>(camera.model.distortion());
}

std::string yaml_matrix(std::string_view name, int rows, const std::vector<double>& values) {
  return fmt::format("{}:\n  rows: {}\n  cols: {}\n  data: [{}]\n", name, rows,
                     values.size() / static_cast<std::size_t>(rows), joined(values));
}

/// As cv::FileStorage writes a cv::Mat of doubles.
std::string opencv_matrix(std::string_view name, int rows, const std::vector<double>& values) {
  return fmt::format("{}: !!opencv-matrix\n   rows: {}\n   cols: {}\n   dt: d\n   data: [ {} ]\n", name, rows,
                     values.size() / static_cast<std::size_t>(rows), joined(values));
}

/// PhotonVision's JsonMatOfDouble; type 6 is OpenCV's CV_64F.
std::string photon_matrix(int rows, const std::vector<double>& values) {
  return fmt::format(R"({{"rows": {}, "cols": {}, "type": 6, "data": [{}]}})", rows,
                     values.size() / static_cast<std::size_t>(rows), joined(values));
}

}  // namespace

// ros-perception/image_common: camera_calibration_parsers/src/parse_yml.cpp.
std::string ros_camera_info_text(const Camera& camera) {
  const std::vector<double> coefficients =
      is_fisheye(camera) ? coefficients_of(camera.model) : radtan_coefficients(camera, "ROS");
  const char* model = is_fisheye(camera)         ? "equidistant"
                      : coefficients.size() == 8 ? "rational_polynomial"
                                                 : "plumb_bob";
  const Pinhole& lens = camera.model.pinhole();
  return fmt::format("image_width: {}\nimage_height: {}\ncamera_name: \"{}\"\n", camera.width, camera.height,
                     camera.name) +
         yaml_matrix("camera_matrix", 3, matrix_of(camera.model)) +
         fmt::format("distortion_model: {}\n", model) +
         yaml_matrix("distortion_coefficients", 1, coefficients) +
         yaml_matrix("rectification_matrix", 3, {1, 0, 0, 0, 1, 0, 0, 0, 1}) +
         yaml_matrix("projection_matrix", 3, {lens.fx, 0, lens.cx, 0, 0, lens.fy, lens.cy, 0, 0, 0, 1, 0});
}

// opencv/opencv: samples/cpp/tutorial_code/calib3d/camera_calibration/camera_calibration.cpp, whose
// fisheye_model tells the two kinds of coefficients apart.
std::string opencv_text(const Camera& camera) {
  std::string text = "%YAML:1.0\n---\n";
  if (camera.width > 0)
    text += fmt::format("image_width: {}\nimage_height: {}\n", camera.width, camera.height);
  if (is_fisheye(camera)) text += "fisheye_model: 1\n";
  return text + opencv_matrix("camera_matrix", 3, matrix_of(camera.model)) +
         opencv_matrix(
             "distortion_coefficients", 1,
             is_fisheye(camera) ? coefficients_of(camera.model) : radtan_coefficients(camera, "OpenCV"));
}

// wpilibsuite/allwpilib: wpical. It reads eight coefficients. An error of 0 stands for one that is not known.
std::string wpilib_text(const Camera& camera) {
  std::vector<double> coefficients = radtan_coefficients(camera, "WPILib JSON");
  coefficients.resize(8, 0.0);
  return fmt::format(
      "{{\n  \"avg_reprojection_error\": 0.0,\n  \"camera_matrix\": [{}],\n"
      "  \"distortion_coefficients\": [{}]\n}}\n",
      joined(matrix_of(camera.model)), joined(coefficients));
}

// PhotonVision/photonvision: CameraCalibrationCoefficients.java. LENSMODEL_OPENCV stands for OpenCV's models
// of any number of coefficients.
std::string photonvision_text(const Camera& camera) {
  return fmt::format(
      "{{\n  \"resolution\": {{\"width\": {}.0, \"height\": {}.0}},\n  \"cameraIntrinsics\": {},\n"
      "  \"distCoeffs\": {},\n  \"observations\": [],\n  \"calobjectWarp\": [0.0, 0.0],\n"
      "  \"calobjectSize\": {{\"width\": 0.0, \"height\": 0.0}},\n  \"calobjectSpacing\": 0.0,\n"
      "  \"lensmodel\": \"LENSMODEL_OPENCV\"\n}}\n",
      camera.width, camera.height, photon_matrix(3, matrix_of(camera.model)),
      photon_matrix(1, radtan_coefficients(camera, "PhotonVision JSON")));
}

}  // namespace apriltrack
