#include <cmath>
#include <numbers>

#include "apriltrack/geometry/rotation.h"
#include "room_painter.h"
#include "scenes.h"

namespace apriltrack {
namespace {

using std::numbers::pi;

/// A fixed camera at the origin of its own frame (x right, y down, z forward), 1.3 m above the floor of a
/// room.
Scene before_fixed_camera(const SceneOptions& options, std::uint64_t seed) {
  Scene scene;
  scene.truth = TruthKind::kJoint;
  scene.truth_body = 0;
  scene.lighting = {.lamp_world = {-0.7, -1.0, -0.2}, .ambient = 0.4, .intensity = 0.95, .reach_m = 2.6};
  scene.room = paint_room({.min_corner = {-2.1, -1.3, -1.0},
                           .max_corner = {1.9, 1.3, 2.6},
                           .up_axis = 1,
                           .up_sign = -1.0,
                           .texel_m = options.texel_m,
                           .seed = seed},
                          scene.lighting);
  return scene;
}

Pose turned(const Eigen::Vector3d& rotation_vector, const Eigen::Vector3d& position) {
  return {rotation_exp(rotation_vector), position};
}

TagMap cube_map(double edge_m, double tag_size_m, int first_id) {
  TagMap map;
  map.frame = "body";
  const double out = 0.5 * edge_m + 0.0003;
  // Front first, then to the right round the cube, then top and bottom; slightly off the middle, as hands
  // glue them.
  const std::array<Pose, 6> faces = {
      turned({0, 0, 0}, {0, 0, -out}),       turned({0, -pi / 2, 0}, {out, 0, 0}),
      turned({0, pi, 0}, {0, 0, out}),       turned({0, pi / 2, 0}, {-out, 0, 0}),
      turned({-pi / 2, 0, 0}, {0, -out, 0}), turned({pi / 2, 0, 0}, {0, out, 0}),
  };
  const std::array<Pose, 6> glued = {
      turned({0, 0, 0.05}, {0.002, -0.0015, 0}),  turned({0, 0, -0.08}, {-0.003, 0.001, 0}),
      turned({0, 0, 0.11}, {0.001, 0.0025, 0}),   turned({0, 0, 0.03}, {0.0015, -0.002, 0}),
      turned({0, 0, -0.05}, {-0.0025, 0.001, 0}), turned({0, 0, 0.07}, {0.001, 0.002, 0}),
  };
  for (std::size_t i = 0; i < faces.size(); ++i) {
    MapTag tag;
    tag.key = {map.default_family, first_id + static_cast<int>(i)};
    tag.size_m = tag_size_m;
    tag.T_map_tag = faces[i] * glued[i];
    map.tags.push_back(tag);
  }
  return map;
}

constexpr double kHaste = 1.5;  // gives a third of the frames and more over 10 px of blur

Channel swing(double offset, std::vector<Wave> waves, std::vector<Burst> bursts = {}) {
  return {.offset = offset, .rate_per_s = 0.0, .waves = std::move(waves), .bursts = std::move(bursts)};
}

Motion thrown_about(double speed) {
  Motion motion;
  motion.position_m = {
      swing(0.0, {{0.07, 0.43, 0.2}, {0.035, 1.13, 1.4}},
            {{0.05, 3.1, 0.2, 2.2, 0.4}, {0.06, 7.2, 0.2, 2.5, 1.0}, {0.06, 11.4, 0.2, 2.6, 0.1}}),
      swing(0.0, {{0.05, 0.37, 1.1}, {0.03, 1.31, 0.3}},
            {{0.05, 4.9, 0.2, 2.4, 0.2}, {0.05, 13.1, 0.2, 2.3, 1.4}}),
      swing(0.55, {{0.09, 0.29, 2.0}, {0.02, 0.9, 0.8}})};
  motion.yaw_rad = swing(0.2, {{0.9, 0.23, 0.1}, {0.18, 1.2, 0.9}},
                         {{0.5, 6.0, 0.2, 2.0, 0.3}, {0.5, 12.3, 0.2, 2.1, 0.8}});
  motion.pitch_rad = swing(-0.3, {{1.9, 0.17, 0.6}, {0.2, 0.95, 2.0}},
                           {{0.5, 2.2, 0.2, 1.9, 1.0}, {0.5, 8.6, 0.2, 2.1, 0.0}});
  motion.roll_rad = swing(0.3, {{1.6, 0.21, 1.8}, {0.22, 1.05, 0.5}}, {{0.45, 4.1, 0.2, 2.2, 0.7}});
  motion.speed = kHaste * speed;
  return motion;
}

Motion moved_by_hand(double speed) {
  Motion motion;
  motion.position_m = {
      swing(0.02, {{0.11, 0.41, 0.3}, {0.05, 1.17, 1.2}},
            {{0.07, 2.6, 0.2, 2.3, 0.3}, {0.08, 5.5, 0.2, 2.6, 1.2}, {0.08, 9.7, 0.2, 2.5, 0.6}}),
      swing(0.01, {{0.05, 0.53, 1.5}, {0.03, 1.41, 0.1}},
            {{0.06, 4.0, 0.2, 2.5, 0.8}, {0.05, 7.1, 0.2, 2.4, 0.0}}),
      swing(0.95, {{0.12, 0.31, 0.9}, {0.03, 1.0, 0.2}})};
  motion.yaw_rad = swing(0.05, {{0.2, 0.47, 0.4}, {0.05, 1.3, 1.9}}, {{0.25, 6.4, 0.2, 2.0, 0.5}});
  motion.pitch_rad = swing(0.1, {{0.4, 0.38, 1.2}, {0.06, 1.5, 0.4}});
  motion.roll_rad = swing(-0.1, {{0.35, 0.44, 2.1}, {0.06, 1.25, 0.9}});
  motion.speed = kHaste * speed;
  return motion;
}

/// A board that comes in from the side at centre_s and leaves again.
Body passing_board(double centre_s, double speed) {
  Body board{.name = "board", .T_world_body = {}, .panels = {}};
  add_plate(board, Pose(), {0.05, 0.16}, 0.28);
  board.T_world_body.position_m = {swing(0.5, {}, {{-0.46, centre_s, 0.45, 0.0, pi / 2}}), swing(0.05, {}),
                                   swing(0.36, {})};
  board.T_world_body.yaw_rad = swing(0.25, {});
  board.T_world_body.speed = speed;
  return board;
}

}  // namespace

Scene make_bundle_scene(const SceneOptions& options) {
  constexpr double kEdge_m = 0.10;
  Scene scene = before_fixed_camera(options, 11);
  scene.name = "bundle";
  scene.camera.model = CameraModel(Pinhole{700.0, 700.0, 319.5, 239.5}, NoDistortion{});
  scene.camera.width = 640;
  scene.camera.height = 480;
  scene.map = cube_map(kEdge_m, 0.07, 20);
  Body cube{.name = "cube", .T_world_body = thrown_about(options.speed), .panels = {}};
  add_box(cube, Pose(), Eigen::Vector3d::Constant(kEdge_m), 0.35);
  add_tags(cube, scene.map, {.margin_cells = 0.0});  // the white cell that the family prints is all that fits
  scene.bodies = {cube, passing_board(6.4, options.speed)};
  scene.exposure_s = 0.014;
  scene.num_frames = 300;
  return scene;
}

Scene make_single_scene(const SceneOptions& options) {
  Scene scene = before_fixed_camera(options, 23);
  scene.name = "single";
  scene.camera.model = CameraModel(Pinhole{1000.0, 1000.0, 639.5, 359.5}, NoDistortion{});
  scene.camera.width = 1280;
  scene.camera.height = 720;
  scene.map.frame = "body";
  MapTag tag;
  tag.key = {scene.map.default_family, 5};
  tag.size_m = 0.16;
  scene.map.tags = {tag};
  Body sheet{.name = "sheet", .T_world_body = moved_by_hand(options.speed), .panels = {}};
  add_plate(sheet, turned({0, 0, 0}, {0.0, 0.015, 0.0}), {0.115, 0.145}, TagPrint{}.paper);
  add_tags(sheet, scene.map);
  Panel thumb;  // where the hand holds the sheet
  thumb.T_body_panel = turned({0, 0, 0.35}, {0.07, 0.145, 0.0});
  thumb.half_size_m = {0.011, 0.024};
  thumb.reflectance = 0.42;
  thumb.is_decal = true;
  sheet.panels.push_back(thumb);
  scene.bodies = {sheet};
  scene.exposure_s = 0.016;
  scene.num_frames = 240;
  return scene;
}

}  // namespace apriltrack
