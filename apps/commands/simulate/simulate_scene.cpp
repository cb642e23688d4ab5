#include "simulate_scene.h"

#include <fmt/format.h>

#include <regex>

#include "apriltrack/base/error.h"
#include "apriltrack/image/exposure.h"
#include "apriltrack/sim/map_scene.h"
#include "apriltrack/sim/named_scenes.h"
#include "apriltrack/sim/stress.h"
#include "simulate_map.h"

namespace apriltrack::app {
namespace {

/// START:COUNT. Whole numbers of at most seven digits, so that none wraps round.
FrameSpan blackout_of(const std::string& text) {
  static const std::regex kForm("([0-9]{1,7}):([0-9]{1,7})");
  std::smatch parts;
  if (!std::regex_match(text, parts, kForm) || std::stoul(parts[2]) == 0)
    throw invalid_input("--blackout",
                        fmt::format("must be START:COUNT, the first black frame (from 0) and how "
                                    "many, such as 90:9 (is '{}')",
                                    text));
  return {std::stoul(parts[1]), std::stoul(parts[2])};
}

void add_stress(const SimulateOptions& options, Scene& scene) {
  scene.formation.noise = options.noise;
  scene.formation.sensor_gain *= options.light;
  scene.formation.amplification = options.gain;
  scene.flicker.depth = options.flicker;
  if (options.take) vary_motion(scene, *options.take);
  if (options.occlude > 0.0) add_passing_hand(scene, options.occlude);
  for (const std::string& text : options.blackouts) {
    const FrameSpan dark = blackout_of(text);
    if (dark.first >= scene.num_frames)
      throw invalid_input("--blackout",
                          fmt::format("'{}' starts after the last frame, {}", text, scene.num_frames - 1));
    scene.blackouts.push_back(dark);
  }
}

/// A named scene or one's own tags, camera and path: wholly the one or the other.
void check_what_is_filmed(const SimulateOptions& options) {
  const bool has_own = !options.map.empty() || !options.camera.empty() || !options.trajectory.empty();
  if (!options.scene.empty() && has_own)
    throw invalid_input(
        "--scene", "films its own tags by its own camera: leave it out, or --map, --camera and --trajectory");
  if (!has_own && options.map_input.is_given())
    throw invalid_input("--map",
                        "is missing: --tag-size, --tag-sizes, --family and --bundle are of its layout");
  if (!has_own && !(options.poses.topic + options.poses.transform).empty())
    throw invalid_input("--trajectory", "is missing: --topic and --transform say which poses of its bag");
  if (options.scene.empty() && !has_own)
    throw invalid_input("--scene", "is missing: name a scene, or give --map, --camera and --trajectory");
  if (!has_own) return;
  for (const auto& [option, value] :
       {std::pair{"--map", &options.map}, std::pair{"--camera", &options.camera},
        std::pair{"--trajectory", &options.trajectory}}) {
    if (value->empty())
      throw invalid_input(
          option, "is missing: one's own tags are filmed by --map, --camera and --trajectory together");
  }
  if (options.take)
    throw invalid_input("--take", "shakes the path of a named scene; a --trajectory is taken as it is");
}

/// A scene goes on for ever, a trajectory ends.
void set_num_frames(const SimulateOptions& options, Scene& scene) {
  const auto asked = static_cast<std::size_t>(*options.frames);
  if (!options.map.empty() && asked > scene.num_frames)
    throw invalid_input("--frames",
                        fmt::format("must be at most {}, as the trajectory holds at {:g} Hz (is {})",
                                    scene.num_frames, scene.rate_hz, asked));
  scene.num_frames = asked;
}

}  // namespace

Scene configured_scene(const SimulateOptions& options) {
  check_what_is_filmed(options);
  Scene scene =
      options.map.empty() ? make_scene(options.scene, {.speed = options.speed}) : scene_of_map(options);
  if (options.rate_hz) scene.rate_hz = *options.rate_hz;
  if (options.exposure_s) scene.exposure_s = *options.exposure_s;
  const double interval_s = 1.0 / scene.rate_hz;
  if (const auto fault = fault_of_exposure(scene.exposure_s)) throw invalid_input("--exposure", *fault);
  if (scene.exposure_s > interval_s) {
    throw invalid_input("--exposure",
                        fmt::format("must be at most {:.6g} s, the frame interval at {:g} Hz (is {:g})",
                                    interval_s, scene.rate_hz, scene.exposure_s));
  }
  if (!options.map.empty()) fit_to_path(scene);
  if (options.frames) set_num_frames(options, scene);
  add_stress(options, scene);
  scene.camera.exposure_s = scene.exposure_s;
  return scene;
}

}  // namespace apriltrack::app
