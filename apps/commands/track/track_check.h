#pragma once

#include "track_options.h"

namespace apriltrack::app {

/// What the parser cannot see: options that exclude each other, inputs that are missing, outputs that would
/// replace what is not theirs. Throws Error.
void check_track_arguments(const CLI::App& command, const TrackArguments& arguments);

}  // namespace apriltrack::app
