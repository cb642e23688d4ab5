#pragma once

#include "apriltrack/sim/scene.h"
#include "simulate_options.h"

namespace apriltrack::app {

/// Of `--map`, `--camera` and `--trajectory`: the user's tags, filmed by the user's camera along the user's
/// path, which begins at time 0. What is odd (gaps of the trajectory, a rolling shutter, which is not
/// rendered) is told to the console. Throws Error that names the file or the option.
Scene scene_of_map(const SimulateOptions& options);

}  // namespace apriltrack::app
