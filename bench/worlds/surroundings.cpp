// Surroundings: a box of walls, furniture and boards in it, and the surfaces on which tags may hang.
#include <cmath>
#include <numbers>

#include "canvas.h"
#include "draw.h"
#include "places.h"

namespace apriltrack::worlds {
namespace {

using std::numbers::pi;

constexpr double kOffSurface_m = 0.003;  // thickness of what a tag is printed on

Eigen::Vector3d room_size(WorldKind kind, Draw& draw) {
  switch (kind) {
    case WorldKind::kCorridor:
      return {draw.uniform(7.0, 14.0), draw.uniform(1.6, 2.6), draw.uniform(2.3, 2.8)};
    case WorldKind::kHall:
      return {draw.uniform(7.0, 11.0), draw.uniform(5.5, 8.0), draw.uniform(2.8, 4.0)};
    default:
      return {draw.uniform(3.0, 6.0), draw.uniform(3.0, 5.0), draw.uniform(2.3, 3.0)};
  }
}

void add_walls(World& world, Draw& draw) {
  const Eigen::Vector3d& size = world.room_size_m;
  const double of_walls = draw.uniform(1.5, 3.0);
  const auto hang = [&](const char* name, const Eigen::Vector3d& inward, double weight) {
    const Eigen::Vector3d centre = 0.5 * size - inward.cwiseProduct(0.5 * size) + kOffSurface_m * inward;
    Surface wall{.name = name, .body = kWalls, .T_body_surface = facing(centre, -inward)};
    const Eigen::Matrix3d R = wall.T_body_surface.rotation_matrix();
    wall.half_size_m = {0.5 * R.col(0).cwiseAbs().dot(size), 0.5 * R.col(1).cwiseAbs().dot(size)};
    wall.weight = weight * wall.half_size_m.prod();
    world.surfaces.push_back(wall);
  };
  hang("wall -x", {1, 0, 0}, of_walls);
  hang("wall +x", {-1, 0, 0}, of_walls);
  hang("wall -y", {0, 1, 0}, of_walls);
  hang("wall +y", {0, -1, 0}, of_walls);
  hang("floor", {0, 0, 1}, draw.chance(0.5) ? 0.6 : 0.0);
  hang("ceiling", {0, 0, -1}, draw.chance(0.4) ? 0.6 : 0.0);
}

/// A box of which every side but the lower one may carry tags.
void add_solid(World& world, const std::string& name, const Pose& T_world_box, const Eigen::Vector3d& size_m,
               double reflectance, double weight) {
  Body body{.name = name, .T_world_body = Motion::fixed(T_world_box), .panels = {}};
  add_box(body, Pose(), size_m, reflectance);
  world.scene.bodies.push_back(body);
  for (int side = 0; side < 5; ++side) {  // not its bottom
    const int axis = side == 4 ? 2 : side / 2;
    const double sign = side == 4 || side % 2 == 1 ? 1.0 : -1.0;
    const Eigen::Vector3d outward = sign * Eigen::Vector3d::Unit(axis);
    Surface surface{.name = name, .body = world.scene.bodies.size() - 1};
    surface.T_body_surface = facing(outward * (0.5 * size_m[axis] + kOffSurface_m), -outward);
    const Eigen::Matrix3d R = surface.T_body_surface.rotation_matrix();
    surface.half_size_m = {0.5 * R.col(0).cwiseAbs().dot(size_m), 0.5 * R.col(1).cwiseAbs().dot(size_m)};
    surface.weight = weight * surface.half_size_m.prod();
    world.surfaces.push_back(surface);
  }
}

/// Cupboards and crates along the walls, pillars in the middle of a hall.
void add_furniture(World& world, Draw& draw) {
  const Eigen::Vector3d& size = world.room_size_m;
  const bool is_narrow = world.kind == WorldKind::kCorridor;
  const int count = draw.integer(0, is_narrow ? 3 : 5);
  for (int i = 0; i < count; ++i) {
    const double depth = is_narrow ? draw.uniform(0.2, 0.4) : draw.uniform(0.3, 0.6);
    const Eigen::Vector3d box(draw.uniform(0.4, 1.2), depth, draw.uniform(0.5, 1.9));
    const double along = draw.uniform(0.1, 0.9) * size.x();
    const double across = draw.chance(0.5) ? 0.5 * depth + 0.02 : size.y() - 0.5 * depth - 0.02;
    const Eigen::Vector3d centre(std::clamp(along, 0.65, size.x() - 0.65), across, 0.5 * box.z() + 0.01);
    if (is_in_solid(world, centre, 0.7)) continue;
    add_solid(world, "cupboard", Pose(Eigen::Quaterniond::Identity(), centre), box, draw.uniform(0.1, 0.6),
              3.0);
  }
  const int pillars = world.kind == WorldKind::kHall ? draw.integer(0, 3) : 0;
  for (int i = 0; i < pillars; ++i) {
    const double width = draw.uniform(0.3, 0.6);
    const Eigen::Vector3d centre(draw.uniform(0.25, 0.75) * size.x(), draw.uniform(0.3, 0.7) * size.y(),
                                 0.5 * size.z());
    if (is_in_solid(world, centre, 0.9)) continue;
    add_solid(world, "pillar", standing(centre, draw.uniform(-0.3, 0.3)), {width, width, size.z() - 0.02},
              draw.uniform(0.3, 0.6), 5.0);
  }
}

/// A board that stands or hangs anyhow, leaning back or forward; in half of the cases another one faces it.
void add_boards(World& world, Draw& draw) {
  const Eigen::Vector3d& size = world.room_size_m;
  const auto add = [&](const Eigen::Vector3d& centre, double yaw, double lean) {
    const Eigen::Vector2d half(draw.uniform(0.15, 0.4), draw.uniform(0.15, 0.35));
    if (is_in_solid(world, centre, 0.5)) return;
    const Eigen::Vector3d outward(std::cos(lean) * std::cos(yaw), std::cos(lean) * std::sin(yaw),
                                  std::sin(lean));
    Body body{.name = "board", .T_world_body = Motion::fixed(facing(centre, -outward)), .panels = {}};
    add_plate(body, Pose(), half, draw.uniform(0.2, 0.7));
    world.scene.bodies.push_back(body);
    world.surfaces.push_back({.name = "board",
                              .body = world.scene.bodies.size() - 1,
                              .T_body_surface = Pose(Eigen::Quaterniond::Identity(), {0, 0, -kOffSurface_m}),
                              .half_size_m = half,
                              .weight = 12.0 * half.prod()});
  };
  const int count = draw.integer(0, world.kind == WorldKind::kCorridor ? 2 : 4);
  for (int i = 0; i < count; ++i) {
    const double lean = draw.chance(0.3) ? 0.0 : draw.uniform(-0.3, 0.9);
    const double yaw = draw.uniform(-pi, pi);
    const Eigen::Vector3d centre(draw.uniform(0.15, 0.85) * size.x(), draw.uniform(0.25, 0.75) * size.y(),
                                 draw.uniform(0.6, 1.7));
    add(centre, yaw, lean);
    const Eigen::Vector3d opposite =
        centre + draw.uniform(1.0, 1.8) * Eigen::Vector3d(std::cos(yaw), std::sin(yaw), 0.0);
    const bool is_inside = (opposite.array() > 0.4).all() && (opposite.array() < size.array() - 0.4).all();
    if (draw.chance(0.5) && is_inside) add(opposite, yaw + pi, draw.uniform(-0.2, 0.3));
  }
}

/// A table in the middle; walls carry no tags.
void add_desk(World& world, Draw& draw) {
  for (Surface& wall : world.surfaces) wall.weight = draw.chance(0.15) ? 0.2 * wall.weight : 0.0;
  const Eigen::Vector3d top(draw.uniform(1.2, 1.8), draw.uniform(0.7, 0.95), 0.03);
  const Eigen::Vector3d centre(0.5 * world.room_size_m.x(), 0.5 * world.room_size_m.y(), 0.74);
  add_solid(world, "desk", Pose(Eigen::Quaterniond::Identity(), centre), top, draw.uniform(0.15, 0.6), 0.0);
  world.surfaces.back().weight = 10.0;  // its upper side
  const int boxes = draw.integer(1, 4);
  for (int i = 0; i < boxes; ++i) {
    const Eigen::Vector3d box(draw.uniform(0.1, 0.35), draw.uniform(0.08, 0.2), draw.uniform(0.08, 0.35));
    const Eigen::Vector3d place =
        centre + Eigen::Vector3d(draw.uniform(-0.35, 0.35) * top.x(), draw.uniform(-0.3, 0.3) * top.y(),
                                 0.016 + 0.5 * box.z());
    if (is_in_solid(world, place + 0.03 * Eigen::Vector3d::UnitZ(), 0.22)) continue;
    add_solid(world, "box", standing(place, draw.uniform(-pi, pi)), box, draw.uniform(0.05, 0.6), 60.0);
  }
}

/// A box with tags, the last of the surfaces. It stands on a stand, or (draw_motion) is turned before a
/// camera at rest.
void add_tagged_box(World& world, Draw& draw) {
  for (Surface& wall : world.surfaces) wall.weight = 0.0;
  const double edge = draw.log_uniform(0.15, 0.7);
  const Eigen::Vector3d size(edge, edge * draw.uniform(0.6, 1.0), edge * draw.uniform(0.6, 1.3));
  const Eigen::Vector3d centre(0.5 * world.room_size_m.x(), 0.5 * world.room_size_m.y(), 1.05);
  const double stand = centre.z() - 0.5 * size.z() - 0.01;
  add_solid(world, "stand", standing({centre.x(), centre.y(), 0.5 * stand}, 0.0), {0.2, 0.2, stand}, 0.2,
            0.0);
  add_solid(world, "tagged box", standing(centre, draw.uniform(-pi, pi)), size, draw.uniform(0.1, 0.6),
            100.0);
}

std::shared_ptr<const Texture> sheet_of_text(const Eigen::Vector2d& half_size_m, Draw& draw) {
  constexpr double kTexel_m = 0.003;
  Canvas canvas(2.0 * half_size_m.x(), 2.0 * half_size_m.y(), kTexel_m,
                static_cast<float>(draw.uniform(0.4, 0.8)));
  const double ink = draw.uniform(0.04, 0.3);
  const Eigen::Vector2d size = 2.0 * half_size_m;
  if (draw.chance(0.6)) {
    canvas.text(0.1 * size.x(), 0.1 * size.y(), 0.8 * size.x(), 0.8 * size.y(), draw.uniform(0.006, 0.02),
                ink, draw.stream());
  } else {
    canvas.stripes(0.1 * size.x(), 0.1 * size.y(), 0.8 * size.x(), 0.8 * size.y(), draw.uniform(0.02, 0.08),
                   draw.chance(0.5), ink);
  }
  const auto texels = [](double length_m) {
    return std::max(2, static_cast<int>(std::lround(length_m / kTexel_m)));
  };
  Image<float> picture(texels(size.x()), texels(size.y()));
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x)
      picture(x, y) = canvas.at((x + 0.5) * kTexel_m, (y + 0.5) * kTexel_m);
  }
  return std::make_shared<const Texture>(std::move(picture), kTexel_m);
}

/// Sheets, books and labels on furniture: what is no tag. Walls have theirs painted on.
void add_clutter(World& world, Draw& draw) {
  for (const Surface& surface : world.surfaces) {
    if (surface.body == kWalls || surface.weight == 0.0) continue;
    const int count = draw.integer(0, 3);
    for (int i = 0; i < count; ++i) {
      Panel sheet;
      sheet.half_size_m = {draw.uniform(0.1, 0.3) * surface.half_size_m.x(),
                           draw.uniform(0.1, 0.3) * surface.half_size_m.y()};
      const Eigen::Vector2d room_for_it = surface.half_size_m - sheet.half_size_m;
      sheet.T_body_panel = surface.T_body_surface * Pose(Eigen::Quaterniond::Identity(),
                                                         {draw.uniform(-1, 1) * room_for_it.x(),
                                                          draw.uniform(-1, 1) * room_for_it.y(), 0.001});
      sheet.picture = sheet_of_text(sheet.half_size_m, draw);
      sheet.is_decal = true;
      world.scene.bodies[surface.body].panels.push_back(sheet);
    }
  }
}

}  // namespace

void draw_surroundings(World& world, std::uint64_t attempt) {
  Draw draw(world.seed, Part::kSurroundings, attempt);
  world.scene.bodies = {Body{.name = "walls", .T_world_body = {}, .panels = {}}};
  world.room_size_m = room_size(world.kind, draw);
  add_walls(world, draw);
  switch (world.kind) {
    case WorldKind::kDesk:
      add_desk(world, draw);
      break;
    case WorldKind::kBody:
      add_tagged_box(world, draw);
      break;
    default:
      add_furniture(world, draw);
      add_boards(world, draw);
  }
  add_clutter(world, draw);
  const Eigen::Vector3d& size = world.room_size_m;
  world.drawn["surroundings"] = {{"size_m", {size.x(), size.y(), size.z()}},
                                 {"bodies", world.scene.bodies.size()}};
}

}  // namespace apriltrack::worlds
