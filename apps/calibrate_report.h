#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "apriltrack/tags/tag_sizes.h"
#include "calibrate_findings.h"
#include "calibrate_options.h"
#include "calibrate_response.h"

namespace apriltrack::app {

/// What a calibration was made from, and what came of it.
struct CalibrateRun {
  std::string command_line;
  const CalibrateOptions& options;
  std::filesystem::path camera_file;
  const Sightings& sightings;
  const TagSizes& sizes;
  const ResponseFindings& responses;
  const CalibrationResult& result;
  const std::optional<RefinementResult>& refinement;
  const CalibrationFindings& findings;
};

/// The page of `calibrate --report`, one file that needs no network: how far the map can be trusted, where
/// not, why, and what would help. Throws Error(kIo).
void write_calibrate_report(const std::filesystem::path& path, const CalibrateRun& run);

/// Where the page of a run without a map goes: "page.no_map.html" beside "page.html".
std::filesystem::path page_without_map(const std::filesystem::path& report);

/// The page of a run that yields no map: why. Throws Error(kIo).
void write_failure_report(const std::filesystem::path& path, const std::string& command_line,
                          const CalibrateOptions& options, const std::string& why);

}  // namespace apriltrack::app
