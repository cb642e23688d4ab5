#pragma once

#include <filesystem>

#include "calibrate_options.h"

namespace apriltrack::app {

/// --camera, else the sequence folders' own: the first one's, which the others must equal in all that a
/// calibration asks (not in exposure). Throws Error(kInvalidInput) where an input has none, or two differ.
std::filesystem::path camera_file(const CalibrateOptions& options);

}  // namespace apriltrack::app
