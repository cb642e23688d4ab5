#include "simulate_options.h"

#include <fmt/format.h>

#include "apriltrack/image/exposure.h"
#include "apriltrack/sim/named_scenes.h"
#include "cli/choice_option.h"
#include "cli/option_checks.h"
#include "files/pose_choice.h"

namespace apriltrack::app {
namespace {

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

}  // namespace

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
