#pragma once

#include <filesystem>
#include <string>

#include "calibrate_run.h"

namespace apriltrack::app {

/// The page of `calibrate --report`, one file that needs no network: how far the map can be trusted, where
/// not, why, and what would help. Throws Error(kIo).
void write_calibrate_report(const std::filesystem::path& path, const CalibrateRun& run);

/// Where the page of a run without a map goes: "page.no_map.html" beside "page.html".
std::filesystem::path page_without_map(const std::filesystem::path& report);

/// The page of a run that yields no map: why. Throws Error(kIo).
void write_failure_report(const std::filesystem::path& path, const std::string& command_line,
                          const CalibrateOptions& options, const std::string& why);

}  // namespace apriltrack::app
