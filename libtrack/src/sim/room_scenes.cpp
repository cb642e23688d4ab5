#include <cmath>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include "room_painter.h"
#include "scenes.h"

namespace apriltrack {
namespace {

using std::numbers::pi;

const Eigen::Vector3d kMinCorner(-2.5, -2.0, 0.0);
const Eigen::Vector3d kMaxCorner(2.5, 2.0, 2.6);
constexpr double kOffWall_m = 0.003;  // the thickness of the board that the tag is glued on

struct Hung {
  Eigen::Vector3d into_wall;
  double along_m;  ///< From the wall's middle, to the right as one faces it.
  double height_m;
  double turned_deg;
};

const std::array<Hung, 14> kTags = {{
    {{0, 1, 0}, -1.85, 1.52, -4.0},
    {{0, 1, 0}, -0.72, 1.24, 7.0},
    {{0, 1, 0}, 0.46, 1.58, 2.0},
    {{0, 1, 0}, 1.71, 1.31, -12.0},
    {{1, 0, 0}, -1.33, 1.29, 3.0},
    {{1, 0, 0}, -0.12, 1.61, -6.0},
    {{1, 0, 0}, 1.18, 1.36, 9.0},
    {{0, -1, 0}, -1.78, 1.37, 5.0},
    {{0, -1, 0}, -0.55, 1.60, -3.0},
    {{0, -1, 0}, 0.61, 1.22, 14.0},
    {{0, -1, 0}, 1.80, 1.49, -8.0},
    {{-1, 0, 0}, -1.21, 1.55, -5.0},
    {{-1, 0, 0}, 0.08, 1.26, 4.0},
    {{-1, 0, 0}, 1.36, 1.47, -10.0},
}};

/// All on the wall x = 2.5; one of them is the lone tag.
const std::array<Hung, 14> kWallTags = {{
    {{1, 0, 0}, -1.16, 0.88, 4.0},
    {{1, 0, 0}, -0.58, 0.93, -7.0},
    {{1, 0, 0}, 0.03, 0.86, 11.0},
    {{1, 0, 0}, 0.62, 0.95, -3.0},
    {{1, 0, 0}, 1.14, 0.87, 6.0},
    {{1, 0, 0}, -0.87, 1.41, -9.0},
    {{1, 0, 0}, -0.05, 1.45, 8.0},
    {{1, 0, 0}, 0.33, 1.38, 2.0},
    {{1, 0, 0}, 0.91, 1.44, -5.0},
    {{1, 0, 0}, -1.13, 1.94, 10.0},
    {{1, 0, 0}, -0.61, 1.88, -2.0},
    {{1, 0, 0}, 0.01, 1.97, 5.0},
    {{1, 0, 0}, 0.57, 1.9, -12.0},
    {{1, 0, 0}, 1.17, 1.93, 3.0},
}};
constexpr std::size_t kMiddleTag = 6;

Pose hang(const Hung& hung) {
  const Eigen::Vector3d down = -Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d right = down.cross(hung.into_wall);
  Eigen::Matrix3d R_world_wall;
  R_world_wall << right, down, hung.into_wall;
  const double to_wall = hung.into_wall.cwiseAbs().dot(kMaxCorner) - kOffWall_m;
  const Pose on_wall(R_world_wall, Eigen::Vector3d(to_wall * hung.into_wall + hung.along_m * right +
                                                   hung.height_m * Eigen::Vector3d::UnitZ()));
  return on_wall *
         Pose(Eigen::Quaterniond(Eigen::AngleAxisd(hung.turned_deg * pi / 180.0, Eigen::Vector3d::UnitZ())),
              Eigen::Vector3d::Zero());
}

TagMap hung_map(std::span<const Hung> hung, double size_m) {
  TagMap map;
  for (std::size_t i = 0; i < hung.size(); ++i) {
    MapTag tag;
    tag.key = {map.default_family, static_cast<int>(i)};
    tag.size_m = size_m;
    tag.T_map_tag = hang(hung[i]);
    map.tags.push_back(tag);
  }
  return map;
}

/// Once round the room in period_s; every frequency is a whole number of turns per period, so that the path
/// closes.
Motion slow_round(double period_s) {
  const auto turns = [&](double amplitude, double count, double phase_rad) {
    return Wave{amplitude, count / period_s, phase_rad};
  };
  Motion motion;
  motion.T_end = camera_looking_along_x();
  motion.position_m[0] = {
      .offset = 0.05, .rate_per_s = 0.0, .waves = {turns(0.75, 1, 0.4), turns(0.12, 3, 1.0)}, .bursts = {}};
  motion.position_m[1] = {
      .offset = -0.1, .rate_per_s = 0.0, .waves = {turns(0.5, 1, 1.9), turns(0.1, 2, 0.2)}, .bursts = {}};
  motion.position_m[2] = {
      .offset = 1.42, .rate_per_s = 0.0, .waves = {turns(0.12, 3, 0.0), turns(0.03, 7, 2.0)}, .bursts = {}};
  motion.yaw_rad = {
      .offset = 0.9, .rate_per_s = 2.0 * pi / period_s, .waves = {turns(0.08, 3, 0.5)}, .bursts = {}};
  motion.pitch_rad.waves = {turns(0.06, 4, 0.3), turns(0.02, 9, 1.1)};
  motion.roll_rad.waves = {turns(0.07, 3, 2.2), turns(0.02, 8, 0.9)};
  return motion;
}

/// Looking at the wall x = 2.5 from so far, as a hand holds it that is jolted at times.
Motion held_before_wall(double distance_m) {
  const auto held = [](double offset, std::vector<Wave> waves, std::vector<Burst> bursts) {
    return Channel{
        .offset = offset, .rate_per_s = 0.0, .waves = std::move(waves), .bursts = std::move(bursts)};
  };
  Motion motion;
  motion.T_end = camera_looking_along_x();
  motion.position_m = {
      held(kMaxCorner.x() - distance_m, {{0.05, 0.41, 0.3}, {0.02, 1.3, 1.0}}, {{0.06, 5.1, 0.18, 2.4, 0.2}}),
      held(0.05, {{0.06, 0.53, 1.1}, {0.02, 1.7, 0.4}},
           {{0.12, 2.6, 0.16, 2.8, 0.5}, {0.12, 6.9, 0.17, 2.5, 1.7}}),
      held(1.42, {{0.04, 0.47, 2.0}, {0.015, 1.5, 0.1}}, {{0.1, 4.0, 0.16, 2.6, 0.9}})};
  motion.yaw_rad = held(0.02, {{0.03, 0.6, 0.2}, {0.02, 2.1, 1.3}},
                        {{0.24, 1.2, 0.16, 2.7, 0.3},
                         {0.26, 3.3, 0.16, 3.0, 1.2},
                         {0.22, 5.9, 0.18, 2.5, 2.4},
                         {0.25, 8.2, 0.16, 2.8, 0.9}});
  motion.pitch_rad =
      held(0.01, {{0.03, 0.5, 1.0}, {0.015, 1.9, 0.6}},
           {{0.17, 2.0, 0.16, 2.8, 0.8}, {0.18, 4.6, 0.16, 2.6, 0.1}, {0.17, 7.4, 0.16, 2.7, 1.5}});
  motion.roll_rad =
      held(0.03, {{0.05, 0.44, 0.7}}, {{0.22, 3.9, 0.16, 2.2, 1.4}, {0.2, 7.0, 0.16, 2.4, 0.2}});
  return motion;
}

/// The same round as a hurried hand makes it: shaking all the time, and jerks.
Motion violent_round(double period_s) {
  Motion motion = slow_round(period_s);
  const auto shake = [&](Channel& channel, double amplitude, double count, double phase_rad) {
    channel.waves.push_back({amplitude, count / period_s, phase_rad});
  };
  shake(motion.position_m[0], 0.05, 11, 0.7);
  shake(motion.position_m[1], 0.04, 13, 2.1);
  shake(motion.position_m[2], 0.04, 15, 1.3);
  shake(motion.yaw_rad, 0.12, 9, 0.3);
  shake(motion.yaw_rad, 0.02, 31, 1.7);
  shake(motion.pitch_rad, 0.07, 14, 0.9);
  shake(motion.roll_rad, 0.05, 17, 2.6);
  motion.yaw_rad.bursts = {{0.30, 1.3, 0.16, 2.6, 0.2}, {0.33, 3.6, 0.15, 3.2, 1.0},
                           {0.26, 5.4, 0.20, 2.2, 2.0}, {0.38, 7.5, 0.14, 2.9, 0.0},
                           {0.28, 9.4, 0.17, 2.7, 2.8}, {0.24, 10.7, 0.15, 3.0, 0.6}};
  motion.pitch_rad.bursts = {{0.16, 1.5, 0.16, 3.0, 1.0},
                             {0.20, 4.5, 0.16, 2.6, 0.4},
                             {0.22, 6.5, 0.15, 2.8, 1.9},
                             {0.15, 8.5, 0.18, 2.4, 0.7},
                             {0.18, 10.2, 0.14, 3.1, 2.4}};
  motion.roll_rad.bursts = {
      {0.20, 2.6, 0.17, 2.1, 0.8}, {0.25, 6.2, 0.18, 2.3, 1.5}, {0.2, 9.0, 0.15, 2.5, 0.1}};
  motion.position_m[0].bursts = {{0.12, 2.7, 0.16, 2.4, 0.5}, {0.14, 8.1, 0.16, 2.6, 1.2}};
  motion.position_m[2].bursts = {{0.10, 4.6, 0.17, 2.2, 0.9}, {0.12, 9.8, 0.16, 2.5, 0.3}};
  return motion;
}

/// The room with its camera; the motion is the caller's.
Scene room_with(const TagMap& map, const SceneOptions& options) {
  Scene scene;
  scene.camera.model =
      CameraModel(Pinhole{520.6, 519.4, 322.4, 237.3}, RadtanDistortion({-0.28, 0.09, 0.0005, -0.0003}));
  scene.camera.width = 640;
  scene.camera.height = 480;
  scene.lighting = {.lamp_world = {0.3, 0.2, 2.45}, .ambient = 0.4, .intensity = 1.0, .reach_m = 2.6};
  scene.room =
      paint_room({.min_corner = kMinCorner, .max_corner = kMaxCorner, .texel_m = options.texel_m, .seed = 4},
                 scene.lighting);
  scene.map = map;
  Body tags{.name = "world", .T_world_body = {}, .panels = {}};
  add_tags(tags, scene.map);
  scene.bodies.push_back(tags);
  return scene;
}

constexpr double kTagSize_m = 0.16;
constexpr double kGentlePeriod_s = 20.0;
constexpr double kViolentPeriod_s = 12.0;

}  // namespace

Scene make_room_scene(const SceneOptions& options, bool is_gentle) {
  Scene scene = room_with(hung_map(kTags, kTagSize_m), options);
  scene.name = is_gentle ? "room-gentle" : "room";
  scene.T_world_camera = is_gentle ? slow_round(kGentlePeriod_s) : violent_round(kViolentPeriod_s);
  scene.T_world_camera.speed = options.speed;
  scene.rate_hz = is_gentle ? 15.0 : 30.0;
  scene.exposure_s = is_gentle ? 0.006 : 0.016;
  scene.num_frames = is_gentle ? 300 : 360;
  return scene;
}

Scene make_small_tags_scene(const SceneOptions& options) {
  constexpr double kSmall_m = 0.096;
  Scene scene = room_with(hung_map(kTags, kSmall_m), options);
  scene.name = "room-small";
  scene.T_world_camera = violent_round(kViolentPeriod_s);
  for (Wave& wave : scene.T_world_camera.position_m[0].waves) wave.amplitude *= 0.1;  // near the middle
  for (Wave& wave : scene.T_world_camera.position_m[1].waves) wave.amplitude *= 0.1;
  scene.T_world_camera.speed = options.speed;
  scene.exposure_s = 0.008;
  scene.num_frames = 360;
  return scene;
}

Scene make_wall_scene(const SceneOptions& options, bool is_lone_tag) {
  Scene scene = is_lone_tag
                    ? room_with(hung_map(std::span(kWallTags).subspan(kMiddleTag, 1), kTagSize_m), options)
                    : room_with(hung_map(kWallTags, kTagSize_m), options);
  scene.name = is_lone_tag ? "wall-one" : "wall";
  scene.T_world_camera = held_before_wall(is_lone_tag ? 1.7 : 3.2);
  scene.exposure_s = 0.02;
  scene.T_world_camera.speed = options.speed;
  scene.num_frames = 264;
  return scene;
}

}  // namespace apriltrack
