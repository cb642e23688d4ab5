#include "apriltrack/sim/scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "apriltrack/base/check.h"
#include "apriltrack/geometry/rotation.h"
#include "apriltrack/sim/renderer.h"

namespace apriltrack {
namespace {

Scene before_camera(Body body) {
  Scene scene;
  scene.truth = TruthKind::kJoint;
  scene.camera.model = CameraModel(Pinhole{500, 500, 159.5, 119.5}, NoDistortion{});
  scene.camera.width = 320;
  scene.camera.height = 240;
  scene.lighting = {.lamp_world = {0, 0, -1000}, .ambient = 1.0, .intensity = 0.0, .reach_m = 1.0};
  scene.bodies = {std::move(body)};
  return scene;
}

TEST(KalibrGrid, IsPrintedAsKalibrLaysItOut) {
  constexpr double kTag_m = 0.08;
  constexpr double kPitch_m = 0.08 * 1.3;
  Body board{.name = "board",
             .T_world_body = Motion::fixed(Pose(Eigen::Quaterniond::Identity(), {0, 0, 1.2})),
             .panels = {}};
  const TagMap map = add_kalibr_grid(board, Pose(), 3, 4, kTag_m, 0.3);
  ASSERT_EQ(map.tags.size(), 12U);
  const Eigen::Vector3d first = map.find({"tag36h11b2", 0})->T_map_tag.translation();
  EXPECT_LT(
      (map.find({"tag36h11b2", 1})->T_map_tag.translation() - first - Eigen::Vector3d(kPitch_m, 0, 0)).norm(),
      1e-12);
  EXPECT_LT((map.find({"tag36h11b2", 4})->T_map_tag.translation() - first - Eigen::Vector3d(0, -kPitch_m, 0))
                .norm(),
            1e-12);

  Scene scene = before_camera(board);
  const Image<float> light = Renderer(scene).radiance({0}, 0.0);
  const auto light_at = [&](double x, double y) {
    const Eigen::Vector2d pixel = scene.camera.model.project(Eigen::Vector3d(x, y, 1.2)).value();
    return light(static_cast<int>(std::lround(pixel.x())), static_cast<int>(std::lround(pixel.y())));
  };
  int num_squares = 0;
  for (int row = 0; row <= 3; ++row) {
    for (int column = 0; column <= 4; ++column) {
      EXPECT_LT(light_at((column - 2) * kPitch_m, (row - 1.5) * kPitch_m), 0.05) << row << ' ' << column;
      ++num_squares;
    }
  }
  EXPECT_EQ(num_squares, 20);
  for (int column = 0; column < 3; ++column)
    EXPECT_GT(light_at((column - 1) * kPitch_m, 0.0), 0.7);  // between tags
  for (const MapTag& tag : map.tags) {                       // a two-cell black border
    const Eigen::Vector3d centre = tag.T_map_tag.translation();
    EXPECT_LT(light_at(centre.x() - 0.46 * kTag_m, centre.y()), 0.05);
    EXPECT_LT(light_at(centre.x(), centre.y() + 0.36 * kTag_m), 0.05);
  }
}

/// The silhouette of a cube in any attitude: its sides must meet without a seam, and cover what is behind.
TEST(Box, SidesMeetWithoutASeam) {
  Body back{.name = "back",
            .T_world_body = Motion::fixed(Pose(Eigen::Quaterniond::Identity(), {0, 0, 3})),
            .panels = {}};
  add_plate(back, Pose(), {3.0, 3.0}, 1.0);
  Body cube{
      .name = "cube",
      .T_world_body = Motion::fixed(Pose(rotation_exp(Eigen::Vector3d(0.5, 0.7, 0.3)), {0.0, 0.0, 1.0})),
      .panels = {}};
  add_box(cube, Pose(), {0.2, 0.2, 0.2}, 0.1);
  Scene scene = before_camera(cube);
  scene.bodies.push_back(back);
  const Image<float> light = Renderer(scene).radiance({0}, 0.0);
  const Pose T_cube_camera = scene.T_camera_map(0.0).inverse();
  int num_inside = 0, num_outside = 0;
  for (int y = 0; y < 240; ++y) {
    for (int x = 0; x < 320; ++x) {
      const Eigen::Vector3d eye = T_cube_camera.translation();
      const Eigen::Vector3d ray =
          T_cube_camera.rotation() * Eigen::Vector3d((x - 159.5) / 500, (y - 119.5) / 500, 1.0);
      double enter = -1e9, leave = 1e9;  // by slabs
      for (int axis = 0; axis < 3; ++axis) {
        const double a = (-0.1 - eye[axis]) / ray[axis];
        const double b = (0.1 - eye[axis]) / ray[axis];
        enter = std::max(enter, std::min(a, b));
        leave = std::min(leave, std::max(a, b));
      }
      if (leave - enter > 0.02) {
        EXPECT_NEAR(light(x, y), 0.1, 2e-3) << x << ' ' << y;
        ++num_inside;
      } else if (leave - enter < -0.03) {
        EXPECT_NEAR(light(x, y), 1.0, 1e-3) << x << ' ' << y;
        ++num_outside;
      }
    }
  }
  EXPECT_GT(num_inside, 8000);
  EXPECT_GT(num_outside, 30000);
}

TEST(Renderer, RefusesWhatItCannotFilm) {
  Body body;
  Scene rolling = before_camera(body);
  rolling.camera.line_delay_s = 1e-5;
  EXPECT_THROW(Renderer{rolling}, MisuseError);
  Scene unsized = before_camera(body);
  unsized.camera.width = 0;
  EXPECT_THROW(Renderer{unsized}, MisuseError);
}

TEST(Motion, FixedStaysAndSpeedScalesTime) {
  const Pose pose(rotation_exp(Eigen::Vector3d(0.1, 0.2, -0.4)), {1, 2, 3});
  const Motion fixed = Motion::fixed(pose);
  EXPECT_TRUE(fixed.is_fixed());
  EXPECT_LT((fixed.at(7.0).matrix() - pose.matrix()).norm(), 1e-14);
  Channel channel{.offset = 1.0,
                  .rate_per_s = 2.0,
                  .waves = {{0.5, 0.25, 0.0}},
                  .bursts = {{0.3, 1.0, 0.2, 0.0, M_PI / 2}}};
  EXPECT_NEAR(channel.at(1.0), 1.0 + 2.0 + 0.5 * std::sin(M_PI / 2) + 0.3, 1e-12);
  EXPECT_FALSE(channel.is_constant());
}

}  // namespace
}  // namespace apriltrack
