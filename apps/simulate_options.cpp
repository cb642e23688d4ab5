#include "simulate_options.h"

#include <fmt/format.h>

#include <regex>

#include "apriltrack/base/error.h"
#include "apriltrack/image/exposure.h"
#include "apriltrack/sim/named_scenes.h"
#include "apriltrack/sim/stress.h"
#include "option_checks.h"

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

}  // namespace

Scene configured_scene(const SimulateOptions& options) {
  Scene scene = make_scene(options.scene, {.speed = options.speed});
  if (options.frames) scene.num_frames = static_cast<std::size_t>(*options.frames);
  if (options.rate_hz) scene.rate_hz = *options.rate_hz;
  if (options.exposure_s) scene.exposure_s = *options.exposure_s;
  const double interval_s = 1.0 / scene.rate_hz;
  if (const auto fault = fault_of_exposure(scene.exposure_s)) throw invalid_input("--exposure", *fault);
  if (scene.exposure_s > interval_s) {
    throw invalid_input("--exposure",
                        fmt::format("must be at most {:.6g} s, the frame interval at {:g} Hz (is {:g})",
                                    interval_s, scene.rate_hz, scene.exposure_s));
  }
  add_stress(options, scene);
  scene.camera.exposure_s = scene.exposure_s;
  return scene;
}

void add_simulate_options(CLI::App& command, SimulateOptions& options) {
  command.add_option("--scene", options.scene, "What to film: see the list above")->required();
  command.add_option("--output", options.output, "Folder to write; must be new or empty, unless --force")
      ->required();
  constexpr int kMaxFrames = 1'000'000;
  command
      .add_option("--frames", options.frames,
                  fmt::format("How many frames, 1 to {} (default: the scene's own)", kMaxFrames))
      ->check(whole_number(1, kMaxFrames));
  add_number(command, "--rate", options.rate_hz, {0.01, 10000.0},
             "Frames per second, {} (default: the scene's own)");
  command.add_option("--exposure", options.exposure_s,
                     fmt::format("Seconds, from {:g} to the frame interval, {:g} at most (default: the "
                                 "scene's own)",
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
