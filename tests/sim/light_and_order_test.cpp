#include <gtest/gtest.h>

#include <cmath>

#include "apriltrack/geometry/rotation.h"
#include "apriltrack/sim/renderer.h"

namespace apriltrack {
namespace {

/// A camera at rest at the origin of the world; one pixel is 2 mm at 1 m. Light from all sides.
Scene seen_by_camera_at_rest(std::vector<Body> bodies) {
  Scene scene;
  scene.truth = TruthKind::kJoint;
  scene.camera.model = CameraModel(Pinhole{500, 500, 159.5, 119.5}, NoDistortion{});
  scene.camera.width = 320;
  scene.camera.height = 240;
  scene.lighting = {.lamp_world = {0, 0, -1000}, .ambient = 1.0, .intensity = 0.0, .reach_m = 1.0};
  scene.bodies = std::move(bodies);
  return scene;
}

Pose at_depth(double x, double depth_m) {
  return {Eigen::Quaterniond::Identity(), {x, 0.0, depth_m}};
}

Body plain_wall(double depth_m, double reflectance) {
  Body wall{.name = "wall", .T_world_body = Motion::fixed(at_depth(0.0, depth_m)), .panels = {}};
  Panel panel;
  panel.half_size_m = {2.0, 2.0};
  panel.reflectance = reflectance;
  wall.panels = {panel};
  return wall;
}

TEST(Steps, GoFromOneValueToTheOther) {
  Channel channel;
  channel.offset = 2.0;
  channel.steps = {{3.0, 5.0, 0.4}};
  EXPECT_NEAR(channel.at(0.0), 2.0, 1e-12);
  EXPECT_NEAR(channel.at(5.0), 3.5, 1e-12);
  EXPECT_NEAR(channel.at(5.4), 2.0 + 3.0 * 0.841344746, 1e-8);  // one standard deviation: tables of Phi
  EXPECT_NEAR(channel.at(10.0), 5.0, 1e-12);
  EXPECT_FALSE(channel.is_constant());
}

TEST(Opacity, TakesItsShareOfTheLightFromBehind) {
  constexpr double kWall = 0.8, kShade = 0.3;
  Panel shade;
  shade.half_size_m = {0.1, 0.1};
  shade.reflectance = 0.0;
  shade.opacity = std::make_shared<const Texture>(Image<float>(20, 20, static_cast<float>(kShade)), 0.01);
  shade.is_decal = true;
  const Body shadow{.name = "shadow", .T_world_body = Motion::fixed(at_depth(0.0, 0.99)), .panels = {shade}};
  Body wall = plain_wall(1.0, kWall);
  wall.panels.front().is_decal = true;  // lies on the walls, as the shadow does, and before it
  const Image<float> light = Renderer(seen_by_camera_at_rest({wall, shadow})).radiance({0}, 0.0);
  EXPECT_NEAR(light(160, 120), kWall * (1.0 - kShade), 1e-5);
  EXPECT_NEAR(light(20, 120), kWall, 1e-5);
}

TEST(Gloss, IsBrightestWhereTheMirroredRayMeetsTheLamp) {
  constexpr double kWall = 0.4, kGloss = 0.5;
  Body wall = plain_wall(1.0, kWall);
  wall.panels.front().gloss = kGloss;
  wall.panels.front().gloss_width_rad = 0.03;
  Scene scene = seen_by_camera_at_rest({wall});
  scene.lighting.lamp_world = {0.3, -0.12, 0.5};  // 0.5 m before the wall; the eye is 1 m before it
  const Image<float> light = Renderer(scene).radiance({0}, 0.0);
  // As a billiard ball goes from the eye by the wall to the lamp: shares of the way as the two distances.
  const Eigen::Vector2d pixel(159.5 + 500 * 0.3 * 1.0 / 1.5, 119.5 - 500 * 0.12 * 1.0 / 1.5);
  Eigen::Vector2d brightest(0, 0);
  float most = 0.0F;
  for (int y = 0; y < light.height(); ++y) {
    for (int x = 0; x < light.width(); ++x) {
      if (light(x, y) <= most) continue;
      most = light(x, y);
      brightest = {x, y};
    }
  }
  EXPECT_LE((brightest - pixel).cwiseAbs().maxCoeff(), 1.0);
  EXPECT_NEAR(most, kWall + kGloss, 0.01 * kGloss);  // of a pixel's middle, beside it
}

TEST(Bend, RollsASheetOnACylinderAndKeepsItsLength) {
  const Bend bend{.curl_rad = 0.8, .twist_rad = 0.0, .width_m = 0.2};
  const double radius_m = bend.width_m / bend.curl_rad;
  const Eigen::Vector3d axis(0.0, 0.0, -radius_m);  // the borders come forward, towards -z
  double length_m = 0.0;
  Eigen::Vector3d last = bend.at(-0.1, 0.03);
  for (int i = 1; i <= 1000; ++i) {
    const Eigen::Vector3d point = bend.at(-0.1 + 0.2 * i / 1000, 0.03);
    EXPECT_NEAR((point - axis - Eigen::Vector3d(0, 0.03, 0)).norm(), radius_m, 1e-12);
    length_m += (point - last).norm();
    last = point;
  }
  EXPECT_NEAR(length_m, bend.width_m, 1e-7);
}

TEST(Bend, TwistsTheBordersAgainstEachOther) {
  const Bend bend{.curl_rad = 0.0, .twist_rad = 0.3, .width_m = 0.2};
  const Eigen::Vector3d left = bend.at(-0.1, 0.1) - bend.at(-0.1, -0.1);
  const Eigen::Vector3d right = bend.at(0.1, 0.1) - bend.at(0.1, -0.1);
  EXPECT_NEAR(std::acos(left.normalized().dot(right.normalized())), 0.3, 1e-12);
  EXPECT_NEAR(left.norm(), 0.2, 1e-12);
}

/// The strips of a sheet leave no seams: on its white margin all is paper.
TEST(BentTag, HasNoSeams) {
  MapTag tag;
  tag.key = {"tag36h11", 7};
  tag.size_m = 0.16;
  Body sheet{.name = "sheet", .T_world_body = Motion::fixed(at_depth(0.0, 1.0)), .panels = {}};
  const TagPrint print{.margin_cells = 1.0, .ink = 0.0, .paper = 0.8};
  const Bend bend = add_bent_tag(sheet, tag, {.curl_rad = 0.6}, print);
  const Scene scene = seen_by_camera_at_rest({sheet});
  const Image<float> light = Renderer(scene).radiance({0}, 0.0);
  for (double u = -0.45; u < 0.45; u += 0.001) {
    const Eigen::Vector3d point =
        at_depth(0.0, 1.0) * bend.at(u * bend.width_m, 0.0975);  // 0.9 cells beyond the black border
    const Eigen::Vector2d pixel = scene.camera.model.project(point).value();
    EXPECT_NEAR(light(static_cast<int>(std::lround(pixel.x())), static_cast<int>(std::lround(pixel.y()))),
                0.8, 0.008)
        << "at " << u;
  }
}

/// A long shelf whose middle is nearer than that of the box before its far end.
TEST(DrawingOrder, PutsWhatIsBeforeAPlaneOverWhatIsBehind) {
  Body shelf{.name = "shelf", .T_world_body = Motion::fixed(at_depth(0.5, 2.0)), .panels = {}};
  add_box(shelf, Pose(), {0.4, 0.4, 3.6}, 0.2);  // from 0.2 to 3.8 m, its side at x = 0.3
  Body box{.name = "box", .T_world_body = Motion::fixed(at_depth(0.2, 3.0)), .panels = {}};
  add_box(box, Pose(), {0.15, 0.1, 0.1}, 0.7);
  for (const bool is_turned : {false, true}) {
    const Scene scene =
        is_turned ? seen_by_camera_at_rest({box, shelf}) : seen_by_camera_at_rest({shelf, box});
    const Image<float> light = Renderer(scene).radiance({0}, 0.0);
    const Eigen::Vector2d pixel = scene.camera.model.project({0.2, 0.0, 2.95}).value();
    EXPECT_NEAR(light(static_cast<int>(pixel.x()), static_cast<int>(pixel.y())), 0.7, 1e-4);
  }
}

}  // namespace
}  // namespace apriltrack
