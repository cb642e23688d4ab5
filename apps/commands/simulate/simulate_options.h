#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "apriltrack/sim/scene.h"
#include "apriltrack/source/bag_poses.h"
#include "cli/console.h"
#include "files/map_input.h"

namespace apriltrack::app {

struct SimulateOptions {
  std::string scene;
  std::string map;  ///< With camera and trajectory instead of a scene.
  MapInputOptions map_input;
  std::string camera;
  std::string camera_name;
  std::string trajectory;
  BagPoseChoice poses;  ///< Of the trajectory.
  TruthKind mode = TruthKind::kEgo;
  std::string output;
  std::optional<long long> frames;
  std::optional<double> rate_hz;
  std::optional<double> exposure_s;
  double speed = 1.0;
  double noise = 1.0;
  double flicker = 0.0;
  double light = 1.0;
  double gain = 1.0;
  double occlude = 0.0;
  std::vector<std::string> blackouts;
  std::optional<std::uint64_t> take;
  std::uint64_t seed = 1;
  int num_threads = 0;
  bool is_forced = false;
  Console console;
};

void add_simulate_options(CLI::App& command, SimulateOptions& options);

}  // namespace apriltrack::app
