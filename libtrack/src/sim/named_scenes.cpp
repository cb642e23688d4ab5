#include "apriltrack/sim/named_scenes.h"

#include <fmt/format.h>

#include <array>
#include <string>

#include "apriltrack/base/error.h"
#include "scenes.h"

namespace apriltrack {
namespace {

constexpr std::array<SceneName, 7> kScenes = {{
    {"room", "a hand-held camera with bursts of fast motion in a 5 x 4 m room with 14 tags of 0.16 m (ego)"},
    {"room-gentle", "the same room, a slow round past every tag: the recording to calibrate from (ego)"},
    {"room-small",
     "the fast round near the room's middle, with tags of 0.096 m: some 15 to 25 px in the image (ego)"},
    {"wall", "a camera held before a wall with 14 tags, all in view at most times, and shaken (ego)"},
    {"wall-one", "the same camera nearer to the wall, with one tag only (ego)"},
    {"bundle", "a cube with 6 tags thrown about before a fixed camera, covered at times (joint)"},
    {"single", "one tag on a sheet moved by hand before a fixed camera (joint)"},
}};

}  // namespace

std::span<const SceneName> named_scenes() {
  return kScenes;
}

Scene make_scene(std::string_view name, const SceneOptions& options) {
  if (name == "room") return make_room_scene(options, false);
  if (name == "room-gentle") return make_room_scene(options, true);
  if (name == "room-small") return make_small_tags_scene(options);
  if (name == "wall") return make_wall_scene(options, false);
  if (name == "wall-one") return make_wall_scene(options, true);
  if (name == "bundle") return make_bundle_scene(options);
  if (name == "single") return make_single_scene(options);
  std::string known;
  for (const SceneName& scene : kScenes) known += fmt::format("{}{}", known.empty() ? "" : ", ", scene.name);
  throw invalid_input("--scene", fmt::format("no scene is called '{}'; there are: {}", name, known));
}

}  // namespace apriltrack
