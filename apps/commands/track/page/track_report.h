#pragma once

#include <filesystem>

#include "track_run.h"

namespace apriltrack::app {

/// The page of `track --report`, one file that needs no network: how far the run can be trusted, where not,
/// and why. Its pictures keep their size however long the recording is. Also of a run without a pose.
/// Throws Error(kIo).
void write_track_report(const std::filesystem::path& path, const TrackRun& run);

}  // namespace apriltrack::app
