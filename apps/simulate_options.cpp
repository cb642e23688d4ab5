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

constexpr std::size_t kMaxFrames = 1'000'000;

void check_range(const char* option, double value, double low, double high, const char* unit) {
  if (value >= low && value <= high) return;  // false for NaN too
  throw invalid_input(option, fmt::format("must lie in [{:g}, {:g}]{} (is {:g})", low, high, unit, value));
}

void check(const SimulateOptions& options) {
  check_range("--speed", options.speed, 0.0, 100.0, "");
  check_range("--noise", options.noise, 0.0, 100.0, "");
  check_range("--flicker", options.flicker, 0.0, 0.9, "");
  check_range("--light", options.light, 0.002, 10.0, "");
  check_range("--gain", options.gain, 0.01, 1000.0, "");
  check_range("--occlude", options.occlude, 0.0, 1.0, "");
  if (options.frames) check_range("--frames", static_cast<double>(*options.frames), 1, kMaxFrames, "");
  if (options.rate_hz) check_range("--rate", *options.rate_hz, 0.01, 10000.0, " Hz");
}

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

}  // namespace

Scene configured_scene(const SimulateOptions& options) {
  check(options);
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
  command.add_option("--frames", options.frames, "How many frames (default: the scene's own)");
  command.add_option("--rate", options.rate_hz, "Frames per second (default: the scene's own)");
  command.add_option("--exposure", options.exposure_s,
                     "Seconds; at most the frame interval (default: the scene's own)");
  command
      .add_option("--speed", options.speed,
                  "Moves so many times faster along the same path; 0 = stands still")
      ->capture_default_str();
  command.add_option("--noise", options.noise, "Scales shot and read noise; 0 = none")->capture_default_str();
  command.add_option("--flicker", options.flicker, "Depth of the lamps' 100 Hz flicker; fills frames.csv")
      ->capture_default_str();
  command
      .add_option("--light", options.light,
                  "Share of the usual light: 0.05 leaves few photons, and a dark image")
      ->capture_default_str();
  command
      .add_option("--gain", options.gain, "Amplifies what the sensor saw, noise included: a camera's gain")
      ->capture_default_str();
  command
      .add_option(
          "--occlude", options.occlude,
          "A hand passes to and fro before the lens, hiding such a share of the image's width; 0 = none")
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
