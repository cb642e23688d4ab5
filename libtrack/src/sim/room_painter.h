#pragma once

#include <cstdint>

#include "apriltrack/sim/scene.h"

namespace apriltrack {

struct RoomPlan {
  Eigen::Vector3d min_corner;
  Eigen::Vector3d max_corner;
  int up_axis = 2;
  double up_sign = 1.0;  ///< -1: the axis points down, as a camera's y.
  double texel_m = 0.003;
  std::uint64_t seed = 1;
};

/// A lived-in room: posters, shelves, a window, a door, boards of text, things that look like tags; the same
/// for the same plan. The light of `lighting` is baked in.
Room paint_room(const RoomPlan& plan, const Lighting& lighting);

}  // namespace apriltrack
