#pragma once

#include <algorithm>

#include "world.h"

namespace apriltrack::worlds {

/// The pose of a flat place with its middle at `centre`; z runs `into` it, and y down the world or, where it
/// lies, along `along`.
inline Pose facing(const Eigen::Vector3d& centre, const Eigen::Vector3d& into,
                   const Eigen::Vector3d& along = Eigen::Vector3d::UnitY()) {
  const Eigen::Vector3d z = into.normalized();
  const Eigen::Vector3d down = std::abs(z.z()) < 0.9 ? Eigen::Vector3d(-Eigen::Vector3d::UnitZ()) : along;
  const Eigen::Vector3d x = down.cross(z).normalized();
  Eigen::Matrix3d R;
  R << x, z.cross(x), z;
  return {R, centre};
}

/// Upright, turned by yaw_rad about the world's z axis.
inline Pose standing(const Eigen::Vector3d& centre, double yaw_rad) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ())), centre};
}

/// Whether a point lies in a body that does not move, or within margin_m of it.
inline bool is_in_solid(const World& world, const Eigen::Vector3d& point_world, double margin_m) {
  constexpr std::ptrdiff_t kSidesOfBox = 6;
  for (const Body& body : world.scene.bodies) {
    if (!body.T_world_body.is_fixed()) continue;
    const Eigen::Vector3d point = body.T_world_body.at(0.0).inverse() * point_world;
    const auto is_side = [](const Panel& panel) { return !panel.is_decal; };
    const auto is_behind = [&](const Panel& side) {
      return (side.T_body_panel.inverse() * point).z() > -margin_m;
    };
    const auto is_near = [&](const Panel& side) {
      const Eigen::Vector3d local = side.T_body_panel.inverse() * point;
      return std::abs(local.z()) < margin_m && std::abs(local.x()) < side.half_size_m.x() + margin_m &&
             std::abs(local.y()) < side.half_size_m.y() + margin_m;
    };
    const std::ptrdiff_t sides = std::ranges::count_if(body.panels, is_side);
    const bool is_hit =
        sides >= kSidesOfBox
            ? std::ranges::all_of(body.panels, [&](const Panel& p) { return p.is_decal || is_behind(p); })
            : std::ranges::any_of(body.panels, [&](const Panel& p) { return is_side(p) && is_near(p); });
    if (is_hit) return true;
  }
  return false;
}

inline constexpr std::size_t kWalls = 0;  ///< The body of all that lies on walls, floor and ceiling.

}  // namespace apriltrack::worlds
