// What disturbs: people who walk by, shadows that move along walls.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "apriltrack/base/timestamp.h"
#include "draw.h"
#include "places.h"

namespace apriltrack::worlds {
namespace {

using std::numbers::pi;

constexpr double kFromCamera_m = 0.5;

bool keeps_away(const World& world, const Motion& walk) {
  for (std::size_t i = 0; i < world.scene.num_frames; ++i) {
    const double t = seconds_between(Timestamp{}, world.scene.timestamp(i));
    const Eigen::Vector3d apart = walk.at(t).translation() - world.scene.T_world_camera.at(t).translation();
    if (apart.head<2>().norm() < kFromCamera_m + 0.25) return false;
    const Eigen::Vector3d chest = walk.at(t).translation() + Eigen::Vector3d(0.0, 0.0, 1.0);
    if (is_in_solid(world, chest, 0.3)) return false;
  }
  return true;
}

/// Legs, chest and head as upright boxes, which walk as one.
void add_person(World& world, const Motion& walk, Draw& draw) {
  struct PartOfPerson {
    Eigen::Vector3d size_m;
    double height_m;  ///< Of its middle.
    double reflectance;
  };
  const double cloth = draw.uniform(0.05, 0.6);
  const PartOfPerson parts[] = {{{0.30, 0.20, 0.82}, 0.42, draw.uniform(0.05, 0.3)},
                                {{0.45, 0.25, 0.60}, 1.14, cloth},
                                {{0.17, 0.19, 0.26}, 1.60, 0.42}};
  for (const PartOfPerson& part : parts) {
    Body body{.name = "person", .T_world_body = walk, .panels = {}};
    add_box(body, Pose(Eigen::Quaterniond::Identity(), {0.0, 0.0, part.height_m}), part.size_m,
            part.reflectance);
    world.scene.bodies.push_back(body);
  }
}

/// Up and down the room, at the pace of people.
Motion draw_walk(const World& world, Draw& draw) {
  const Eigen::Vector3d& size = world.room_size_m;
  constexpr double kFromWall_m = 0.35;
  Motion walk;
  const std::size_t along = draw.chance(0.5) || size.y() < 2.0 * kFromWall_m + 0.5 ? 0 : 1;
  const std::size_t across = 1 - along;
  const double reach = 0.5 * size[static_cast<Eigen::Index>(along)] - kFromWall_m;
  const double pace_m_s = draw.uniform(0.4, 1.3);
  walk.position_m[along].offset = 0.5 * size[static_cast<Eigen::Index>(along)];
  walk.position_m[along].waves = {{reach, pace_m_s / (2.0 * pi * reach), draw.uniform(0.0, 2.0 * pi)}};
  walk.position_m[across].offset =
      draw.uniform(kFromWall_m, size[static_cast<Eigen::Index>(across)] - kFromWall_m);
  walk.position_m[2].waves = {{0.02, 1.8, 0.0}};
  walk.yaw_rad = {
      .offset = along == 0 ? 0.5 * pi : 0.0, .rate_per_s = 0.0, .waves = {{0.1, 0.9, 0.0}}, .bursts = {}};
  return walk;
}

/// Opacity with a soft border, as wide as the shadow of a lamp of some size.
std::shared_ptr<const Texture> soft_shadow(const Eigen::Vector2d& half_size_m, double depth,
                                           double penumbra_m) {
  constexpr double kTexel_m = 0.02;
  const auto texels = [](double half_m) {
    return std::max(8, static_cast<int>(std::lround(2.0 * half_m / kTexel_m)));
  };
  Image<float> opacity(texels(half_size_m.x()), texels(half_size_m.y()));
  const auto share = [&](int i, int count) {  // 0 at the border, 1 from the penumbra inwards
    const double inside = std::min(i + 0.5, count - i - 0.5) * kTexel_m;
    const double t = std::clamp(inside / penumbra_m, 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
  };
  for (int y = 0; y < opacity.height(); ++y) {
    for (int x = 0; x < opacity.width(); ++x)
      opacity(x, y) = static_cast<float>(depth * share(x, opacity.width()) * share(y, opacity.height()));
  }
  return std::make_shared<const Texture>(std::move(opacity), kTexel_m);
}

/// The shadow of something flat that moves along a wall before a lamp moves rigidly, too. It falls on the
/// wall and on what hangs there.
void add_shadow(World& world, Draw& draw) {
  const Surface& wall = world.surfaces[static_cast<std::size_t>(draw.integer(0, 4))];
  Panel shade;
  shade.half_size_m = {draw.uniform(0.15, 0.30) * wall.half_size_m.x(),
                       draw.uniform(0.3, 0.8) * wall.half_size_m.y()};
  shade.reflectance = 0.0;
  // Of the light on a wall, a lamp gives a part, and only that is taken.
  const double lamp_share =
      world.scene.lighting.intensity / (world.scene.lighting.intensity + 2.0 * world.scene.lighting.ambient);
  shade.opacity =
      soft_shadow(shade.half_size_m, lamp_share * draw.uniform(0.5, 1.0), draw.uniform(0.05, 0.25));
  shade.is_decal = true;
  Motion motion;
  const Pose& T_world_wall = wall.T_body_surface;
  const Eigen::Vector3d right = T_world_wall.rotation() * Eigen::Vector3d::UnitX();
  const double reach = wall.half_size_m.x() - shade.half_size_m.x();
  const double frequency_hz = draw.uniform(0.05, 0.2);
  const double phase = draw.uniform(0.0, 2.0 * pi);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto index = static_cast<Eigen::Index>(axis);
    motion.position_m[axis].offset = T_world_wall.translation()[index];
    motion.position_m[axis].waves = {{reach * right[index], frequency_hz, phase}};
  }
  motion.T_end = Pose(T_world_wall.rotation(), Eigen::Vector3d::Zero());
  Body body{.name = "shadow", .T_world_body = motion, .panels = {shade}};
  world.scene.bodies.push_back(body);
}

}  // namespace

void draw_disturbances(World& world, std::uint64_t attempt) {
  Draw draw(world.seed, Part::kDisturbances, attempt);
  const bool has_people = world.kind != WorldKind::kBody && draw.chance(0.4);
  int people = 0;
  for (int i = 0; has_people && i < 3 && people < 2; ++i) {
    const Motion walk = draw_walk(world, draw);
    if (!keeps_away(world, walk)) continue;
    add_person(world, walk, draw);
    ++people;
  }
  const int shadows = draw.chance(0.4) ? draw.integer(1, 3) : 0;
  for (int i = 0; i < shadows; ++i) add_shadow(world, draw);
  const bool has_gloss = draw.chance(0.35);
  const double gloss = has_gloss ? draw.log_uniform(0.15, 1.5) : 0.0;
  const double width_rad = draw.log_uniform(0.03, 0.2);
  world.drawn["disturbances"] = {
      {"people", people}, {"shadows", shadows}, {"gloss", gloss}, {"gloss_width_rad", width_rad}};
}

}  // namespace apriltrack::worlds
