#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "apriltrack/detect/response_finding.h"
#include "apriltrack/tags/tag_sizes.h"
#include "calibrate_findings.h"
#include "calibrate_input.h"
#include "calibrate_options.h"

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

}  // namespace apriltrack::app
