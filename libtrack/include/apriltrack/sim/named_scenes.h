#pragma once

#include <span>
#include <string_view>

#include "apriltrack/sim/scene.h"

namespace apriltrack {

struct SceneName {
  std::string_view name;
  std::string_view summary;
};

/// "room", "room-gentle", "room-small", "wall", "wall-one", "bundle", "single".
std::span<const SceneName> named_scenes();

struct SceneOptions {
  double speed = 1.0;      ///< Motion that many times faster along the same path.
  double texel_m = 0.003;  ///< Grain of the painted walls.
};

/// Throws Error(kInvalidInput) that lists the names.
Scene make_scene(std::string_view name, const SceneOptions& options = {});

}  // namespace apriltrack
