#pragma once

#include "apriltrack/sim/named_scenes.h"

namespace apriltrack {

Scene make_room_scene(const SceneOptions& options, bool is_gentle);
Scene make_small_tags_scene(const SceneOptions& options);
Scene make_wall_scene(const SceneOptions& options, bool is_lone_tag);
Scene make_bundle_scene(const SceneOptions& options);
Scene make_single_scene(const SceneOptions& options);

}  // namespace apriltrack
