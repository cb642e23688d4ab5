#include "apriltrack/sim/named_scenes.h"

#include <fmt/format.h>

#include <array>
#include <string>

#include "apriltrack/base/error.h"
#include "scenes.h"

namespace apriltrack {
namespace {

constexpr std::array<SceneName, 4> kScenes = {{
    {"room", "a hand-held camera with bursts of fast motion in a 5 x 4 m room with 14 tags of 0.16 m (ego)"},
    {"room-gentle", "the same room, a slow round past every tag: the recording to calibrate from (ego)"},
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
  if (name == "bundle") return make_bundle_scene(options);
  if (name == "single") return make_single_scene(options);
  std::string known;
  for (const SceneName& scene : kScenes) known += fmt::format("{}{}", known.empty() ? "" : ", ", scene.name);
  throw invalid_input("--scene", fmt::format("no scene is called '{}'; there are: {}", name, known));
}

}  // namespace apriltrack
