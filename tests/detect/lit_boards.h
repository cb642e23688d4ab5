#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "apriltrack/base/random.h"
#include "apriltrack/sim/renderer.h"
#include "apriltrack/tags/tag_map.h"

namespace apriltrack::test {

inline constexpr double kBoardsFocal_px = 500.0;

/// One picture, 640 x 480, of what a lamp and the sky light; blur and noise drawn. Nothing is in it.
inline Scene lit_scene(RandomStream& random) {
  Scene scene;
  scene.camera.model = CameraModel(Pinhole{kBoardsFocal_px, kBoardsFocal_px, 319.5, 239.5}, NoDistortion{});
  scene.camera.width = 640;
  scene.camera.height = 480;
  scene.num_frames = 1;
  scene.formation.lens_blur_sigma_px = random.uniform(0.4, 0.8);
  scene.formation.full_well = random.uniform(2000.0, 9000.0);
  scene.T_world_camera = Motion::fixed(Pose());
  scene.lighting = {.lamp_world = {0.3, -0.5, 0.0}, .ambient = 0.5, .intensity = 0.5, .reach_m = 2.0};
  return scene;
}

/// Of the i-th of twelve boards, 1 m before the camera: tilted about an axis in its plane by up to
/// max_tilt_deg, and turned in its plane at random.
inline Pose pose_of_board(int i, double axis_rad, double max_tilt_deg, RandomStream& random) {
  using std::numbers::pi;
  return Pose(
      Eigen::AngleAxisd(random.uniform(0.0, max_tilt_deg) * pi / 180.0,
                        Eigen::Vector3d(std::cos(axis_rad), std::sin(axis_rad), 0.0)) *
          Eigen::Quaterniond(Eigen::AngleAxisd(random.uniform(0.0, 2.0 * pi), Eigen::Vector3d::UnitZ())),
      Eigen::Vector3d((i % 4 - 1.5) * 0.3, (i / 4 - 1.0) * 0.3, 1.0));
}

/// Tags of 20 to 60 px, seen at 0 to 65 degrees: the simulator's picture, exact to a thousandth of a pixel,
/// which the test's own renderer is not.
inline Scene lit_boards(std::uint64_t seed) {
  using std::numbers::pi;
  RandomStream random(seed);
  Scene scene = lit_scene(random);
  Body boards{.name = "world", .T_world_body = {}, .panels = {}};
  for (int i = 0; i < 12; ++i) {
    const double axis = random.uniform(0.0, 2.0 * pi);
    MapTag tag;
    tag.key = {"tag36h11", 40 * i + static_cast<int>(seed)};
    tag.size_m = 20.0 * std::pow(3.0, random.uniform()) / kBoardsFocal_px;
    tag.T_map_tag = pose_of_board(i, axis, 45.0, random);
    scene.map.tags.push_back(tag);
  }
  add_tags(boards, scene.map, {.margin_cells = 1.0});
  scene.bodies.push_back(boards);
  return scene;
}

}  // namespace apriltrack::test
