#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "apriltrack/camera/camera.h"

namespace apriltrack::test {

/// Cameras of each kind of lens that the formats hold: fx, fy, cx and cy differ, all coefficients are there,
/// the numbers have no short decimals, and the lens holds in the whole picture.
inline std::vector<Camera> format_cameras() {
  const auto camera = [](const Pinhole& pinhole, const Distortion& lens) {
    return Camera{.model = CameraModel(pinhole, lens),
                  .width = 1283,
                  .height = 967,
                  .response_origin = ResponseOrigin::kAssumed};
  };
  return {
      camera({1000.0 / 3.0 * 4.0, 1277.1234567890123, 622.0 + 1.0 / 7.0, 501.0 - 1.0 / 9.0}, NoDistortion()),
      camera({1200.0 / 7.0 * 8.0, 1366.0 + 1.0 / 3.0, 655.0 + 1.0 / 7.0, 470.0 - 1.0 / 9.0},
             RadtanDistortion({-0.1 - 1.0 / 30.0, 0.2 / 3.0, 0.002 / 3.0, -0.001 / 7.0})),
      camera({1200.0 / 7.0 * 8.0, 1360.0 + 1.0 / 3.0, 633.0 + 1.0 / 7.0, 499.0 - 1.0 / 9.0},
             RadtanDistortion({-0.1 - 1.0 / 30.0, 0.2 / 3.0, -0.002 / 3.0, 0.001 / 7.0, 0.01 / 3.0})),
      camera({1200.0 / 7.0 * 8.0, 1388.0 + 1.0 / 3.0, 640.0 + 1.0 / 7.0, 466.0 - 1.0 / 9.0},
             RadtanDistortion({0.4 / 3.0, -0.2 / 7.0, -0.002 / 3.0, 0.001 / 7.0, 0.01 / 3.0, 0.2 / 3.0,
                               0.01 / 7.0, 0.003 / 11.0})),
      // Below 90 degrees: OpenCV and COLMAP project from the plane at unit distance.
      camera({2200.0 / 3.0, 721.0 + 1.0 / 7.0, 660.0 + 1.0 / 3.0, 463.0 - 1.0 / 9.0},
             EquidistantDistortion({-0.02 / 3.0, 0.01 / 7.0, -0.002 / 3.0, 0.0001 / 3.0})),
  };
}

/// 1000 pixels and more, evenly over the picture, corners included.
inline std::vector<Eigen::Vector2d> pixels_over(const Camera& camera) {
  constexpr int kColumns = 40;
  constexpr int kRows = 26;
  std::vector<Eigen::Vector2d> pixels;
  for (int i = 0; i < kColumns; ++i) {
    for (int j = 0; j < kRows; ++j)
      pixels.emplace_back((camera.width - 1.0) * i / (kColumns - 1.0),
                          (camera.height - 1.0) * j / (kRows - 1.0));
  }
  return pixels;
}

/// Points that are seen there, at distances that differ.
inline std::vector<Eigen::Vector3d> points_over(const Camera& camera) {
  std::vector<Eigen::Vector3d> points;
  for (const Eigen::Vector2d& pixel : pixels_over(camera)) {
    const auto ray = camera.model.unproject(pixel);
    if (ray) points.push_back((1.0 + 0.37 * static_cast<double>(points.size() % 11)) * *ray);
  }
  return points;
}

}  // namespace apriltrack::test
