#include "simulate_options.h"

#include <fmt/format.h>

#include <regex>

#include "apriltrack/base/error.h"
#include "apriltrack/image/exposure.h"
#include "apriltrack/sim/map_scene.h"
#include "apriltrack/sim/named_scenes.h"
#include "apriltrack/sim/stress.h"
#include "choice_option.h"
#include "option_checks.h"
#include "pose_choice.h"
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

struct OptionRange {
  double low = 0.0;
  double high = 0.0;
};

/// help: with {} where the range is to be told.
template <class Number>
CLI::Option* add_number(CLI::App& command, const char* name, Number& value, const OptionRange& range,
                        const char* help) {
  const std::string limits = fmt::format("{:g} to {:g}", range.low, range.high);
  return command.add_option(name, value, fmt::format(fmt::runtime(help), limits))
      ->check(number_between(range.low, range.high));
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

void add_simulate_options(CLI::App& command, SimulateOptions& options) {
  command.add_option("--scene", options.scene, "What to film: see the list above");
  command.add_option("--map", options.map, "Film these tags instead, by --camera along --trajectory");
  add_map_input_options(command, options.map_input);
  command.add_option("--camera", options.camera,
                     "Of --map: the camera file; its exposure_time and response hold, too");
  command.add_option("--camera-name", options.camera_name,
                     "Which camera of a file with several; default: the first");
  command.add_option(
      "--trajectory", options.trajectory,
      "Of --map: trajectory (TUM, EuRoC's csv, KITTI, a bag) of T_world_camera, or of T_camera_body "
      "with --mode joint; a smooth "
      "curve leads through its poses");
  add_pose_choice_options(command, options.poses);
  add_choice<TruthKind>(
      command, "--mode", options.mode, {{"ego", TruthKind::kEgo}, {"joint", TruthKind::kJoint}},
      "Of --map: ego, a camera moves through a world of tags; joint, a body of tags moves before it");
  command.add_option("--output", options.output, "Folder to write; must be new or empty, unless --force")
      ->required();
  constexpr int kMaxFrames = 1'000'000;
  command
      .add_option("--frames", options.frames,
                  fmt::format("How many frames, 1 to {} (default: the scene's own, or the whole trajectory)",
                              kMaxFrames))
      ->check(whole_number(1, kMaxFrames));
  add_number(command, "--rate", options.rate_hz, {0.01, 10000.0},
             "Frames per second, {} (default: the scene's own, or the trajectory's)");
  command.add_option("--exposure", options.exposure_s,
                     fmt::format("Seconds, from {:g} to the frame interval, {:g} at most (default: the "
                                 "scene's or the camera file's own)",
                                 kMinExposure_s, kMaxExposure_s));
  add_number(command, "--speed", options.speed, {0.0, 100.0},
             "Moves so many times faster along the same path, {}; 0 = stands still")
      ->capture_default_str();
  add_number(command, "--noise", options.noise, {0.0, 100.0}, "Scales shot and read noise, {}; 0 = none")
      ->capture_default_str();
  add_number(command, "--flicker", options.flicker, {0.0, 0.9},
             "Depth of the lamps' 100 Hz flicker, {}; fills frames.csv")
      ->capture_default_str();
  add_number(command, "--light", options.light, {0.002, 10.0},
             "Share of the usual light, {}: 0.05 leaves few photons, and a dark image")
      ->capture_default_str();
  add_number(command, "--gain", options.gain, {0.01, 1000.0},
             "Amplifies what the sensor saw, noise included, {}: a camera's gain")
      ->capture_default_str();
  add_number(command, "--occlude", options.occlude, {0.0, 1.0},
             "A hand passes to and fro before the lens, hiding such a share of the image's width, {}; 0 = "
             "none")
      ->capture_default_str();
  command.add_option("--blackout", options.blackouts,
                     "START:COUNT, black frames from START (counted from 0); may be given several times");
  command
      .add_option("--take", options.take,
                  "Another take: the same path, shaken otherwise, as drawn from this number")
      ->check(seed());
  command.add_option("--seed", options.seed, "The same seed gives the same bytes")
      ->check(seed())
      ->capture_default_str();
  command.add_option("--threads", options.num_threads, "0 = all cores; changes no byte")
      ->check(threads())
      ->capture_default_str();
  command.add_flag("--force", options.is_forced,
                   "Replace a recording that simulate made; one of your own is never touched");
  options.console.add_options(command);
}

}  // namespace apriltrack::app
