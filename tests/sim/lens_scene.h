#pragma once

#include "apriltrack/geometry/rotation.h"
#include "apriltrack/sim/renderer.h"
#include "blurred_step.h"

namespace apriltrack::test {

constexpr double kMaxLensShift_px = 1e-3;  // of edges
constexpr double kLensFocal_px = 100.0;
constexpr int kLensWidth = 64;
constexpr int kLensHeight = 48;

/// Before a camera at rest one body 1 m away, on which one pixel is 1 cm, evenly lit on black.
inline Scene lens_scene(double sigma_px, Body body) {
  Scene scene;
  scene.truth = TruthKind::kJoint;
  scene.camera.model =
      CameraModel(Pinhole{kLensFocal_px, kLensFocal_px, 0.5 * kLensWidth, 0.5 * kLensHeight}, NoDistortion{});
  scene.camera.width = kLensWidth;
  scene.camera.height = kLensHeight;
  scene.lighting = {.lamp_world = {0, 0, -1000}, .ambient = 1.0, .intensity = 0.0, .reach_m = 1.0};
  scene.formation.vignetting = 0.0;
  scene.formation.sensor_gain = 1.0;
  scene.formation.noise = 0.0;
  scene.formation.lens_blur_sigma_px = sigma_px;
  scene.bodies = {std::move(body)};
  return scene;
}

/// A white rectangle; offsets and half sizes in pixels, from the middle of the picture.
inline Body white_panel(const Eigen::Vector2d& centre_px, const Eigen::Vector2d& half_size_px,
                        double turn_rad = 0.0) {
  Panel panel;
  panel.half_size_m = half_size_px / kLensFocal_px;
  panel.reflectance = 1.0;
  const Eigen::Vector3d place(centre_px.x() / kLensFocal_px, centre_px.y() / kLensFocal_px, 1.0);
  return {.name = "panel",
          .T_world_body = Motion::fixed(Pose(rotation_exp(Eigen::Vector3d(0, 0, turn_rad)), place)),
          .panels = {panel}};
}

/// Of a pixel's centre, from the middle of the picture.
inline double from_middle_x(int x) {
  return x - 0.5 * kLensWidth;
}
inline double from_middle_y(int y) {
  return y - 0.5 * kLensHeight;
}

inline Image<float> light_behind(const Scene& scene, double exposure_s = 0.0) {
  return Renderer(scene).sensor_light({0}, exposure_s);
}

}  // namespace apriltrack::test
