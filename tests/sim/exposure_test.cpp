#include <gtest/gtest.h>

#include <cmath>

#include "apriltrack/sim/renderer.h"

namespace apriltrack {
namespace {

constexpr double kMaxStreakError_px = 0.05;

/// A small white square on a turning and moving arm before black; its world is otherwise empty.
Scene scene_with_dot(const Eigen::Vector3d& dot_body) {
  Scene scene;
  scene.truth = TruthKind::kJoint;
  scene.camera.model = CameraModel(Pinhole{400, 400, 159.5, 119.5}, NoDistortion{});
  scene.camera.width = 320;
  scene.camera.height = 240;
  scene.lighting = {.lamp_world = {0, 0, -1000}, .ambient = 1.0, .intensity = 0.0, .reach_m = 1.0};
  Body body{.name = "arm", .T_world_body = {}, .panels = {}};
  Panel dot;
  dot.T_body_panel = Pose(Eigen::Quaterniond::Identity(), dot_body);
  dot.half_size_m = {0.004, 0.004};
  dot.reflectance = 1.0;
  body.panels = {dot};
  body.T_world_body.position_m[2].offset = 1.0;
  scene.bodies = {body};
  return scene;
}

struct Streak {
  Eigen::Vector2d centre_px = Eigen::Vector2d::Zero();
  double light = 0.0;      ///< Pixels times radiance.
  double length_px = 0.0;  ///< Of a uniform streak with this spread.
};

Streak measure(const Image<float>& image) {
  Streak streak;
  Eigen::Matrix2d second = Eigen::Matrix2d::Zero();
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      const Eigen::Vector2d pixel(x, y);
      streak.light += image(x, y);
      streak.centre_px += image(x, y) * pixel;
      second += image(x, y) * pixel * pixel.transpose();
    }
  }
  streak.centre_px /= streak.light;
  const Eigen::Matrix2d covariance = second / streak.light - streak.centre_px * streak.centre_px.transpose();
  streak.length_px = std::sqrt(12.0 * covariance.trace());
  return streak;
}

TEST(Exposure, CentreOfATranslatingStreakIsAtTheTimeStamp) {
  Scene scene = scene_with_dot({0, 0, 0});
  scene.bodies[0].T_world_body.position_m[0].rate_per_s = 5.0;  // 2000 px/s
  scene.bodies[0].T_world_body.position_m[1].rate_per_s = -3.0;
  const double exposure_s = 0.02;
  const Renderer renderer(scene);
  for (const std::int64_t ns : {-15'300'000, -3'000'000, 4'700'000, 14'900'000}) {
    const double t = 1e-9 * static_cast<double>(ns);
    const Streak streak = measure(renderer.radiance({ns}, exposure_s));
    EXPECT_NEAR(streak.centre_px.x(), 159.5 + 2000.0 * t, kMaxStreakError_px);
    EXPECT_NEAR(streak.centre_px.y(), 119.5 - 1200.0 * t, kMaxStreakError_px);
    // Light is neither lost nor won: the dot has 3.2 x 3.2 px; the streak is 46.6 px long, and the dot adds
    // its own.
    EXPECT_NEAR(streak.light, 3.2 * 3.2, 0.01);
    EXPECT_NEAR(streak.length_px, std::hypot(0.02 * std::hypot(2000.0, 1200.0), std::sqrt(2.0) * 3.2), 0.2);
  }
}

TEST(Exposure, CentreOfATurningStreakIsTheMeanOfItsArc) {
  const double radius_m = 0.2;
  const double rate = 15.0;  // rad/s: 0.3 rad of arc, 24 px
  Scene scene = scene_with_dot({radius_m, 0, 0});
  scene.bodies[0].T_world_body.yaw_rad.rate_per_s = rate;
  const double exposure_s = 0.02;
  const Renderer renderer(scene);
  for (const std::int64_t ns : {0, 70'000'000, 161'000'000}) {
    const double angle = rate * 1e-9 * static_cast<double>(ns);
    const double half = 0.5 * rate * exposure_s;
    const double mean_radius_px = 400.0 * radius_m * std::sin(half) / half;  // closed form of the arc's mean
    const Streak streak = measure(renderer.radiance({ns}, exposure_s));
    EXPECT_NEAR(streak.centre_px.x(), 159.5 + mean_radius_px * std::cos(angle), kMaxStreakError_px);
    EXPECT_NEAR(streak.centre_px.y(), 119.5 + mean_radius_px * std::sin(angle), kMaxStreakError_px);
  }
}

TEST(Exposure, CentreOfAStreakFromATurningCameraIsAtTheTimeStamp) {
  // The dot goes through the middle of the picture, where tan is odd: the centre is the middle by symmetry.
  Scene scene = scene_with_dot({0, 0, 0});
  scene.T_world_camera.pitch_rad.rate_per_s = 4.0;  // about the camera's y axis: 32 px
  const Streak streak = measure(Renderer(scene).radiance({0}, 0.02));
  EXPECT_NEAR(streak.centre_px.x(), 159.5, kMaxStreakError_px);
  EXPECT_NEAR(streak.centre_px.y(), 119.5, kMaxStreakError_px);
  EXPECT_NEAR(streak.length_px, std::hypot(2.0 * 400.0 * std::tan(0.04), std::sqrt(2.0) * 3.2), 0.3);
}

TEST(Exposure, AddsLightAndNotGreyLevels) {
  // A plate that is in front of a pixel for half of the exposure sends it half of its light.
  Scene scene = scene_with_dot({0.1, 0, 0});
  scene.bodies[0].panels[0].half_size_m = {0.1, 0.1};           // left edge at the body's origin
  scene.bodies[0].T_world_body.position_m[0].rate_per_s = 5.0;  // edge from 139.5 to 179.5
  const Image<float> light = Renderer(scene).radiance({0}, 0.02);
  for (const int x : {145, 150, 160, 170, 175}) EXPECT_NEAR(light(x, 119), (x - 139.5) / 40.0, 0.01) << x;
}

TEST(Exposure, FlickerMultipliesTheLightOfTheFrame) {
  Scene scene = scene_with_dot({0, 0, 0});
  scene.flicker = {.depth = 0.4, .frequency_hz = 100.0, .phase_rad = 0.3};
  scene.exposure_s = 0.004;
  const RenderedFrame frame = Renderer(scene).render(3);
  const double t = seconds_between(Timestamp{}, frame.timestamp);
  const double w = 200.0 * M_PI;
  const double mean =
      1.0 + 0.4 * (std::cos(w * (t - 0.002) + 0.3) - std::cos(w * (t + 0.002) + 0.3)) / (w * 0.004);
  EXPECT_NEAR(frame.light, mean, 2e-3);
  const Streak streak = measure(Renderer(scene).radiance(frame.timestamp, 0.004));
  EXPECT_NEAR(streak.light, 3.2 * 3.2 * mean, 0.05);
}

}  // namespace
}  // namespace apriltrack
