#pragma once

#include "apriltrack/sim/scene.h"
#include "simulate_options.h"

namespace apriltrack::app {

/// The named scene, or the user's own, as the options change it. Throws Error(kInvalidInput) that names the
/// option, its value and its range.
Scene configured_scene(const SimulateOptions& options);

}  // namespace apriltrack::app
