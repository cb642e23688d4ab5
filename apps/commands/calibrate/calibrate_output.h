#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apriltrack/calib/calibrate_map.h"
#include "calibrate_findings.h"
#include "calibrate_input.h"
#include "calibrate_options.h"
#include "calibrate_response.h"

namespace apriltrack::app {

/// What a calibration leaves on the disk, the map itself aside.
struct CalibrationFiles {
  std::optional<std::filesystem::path> observations;  ///< None where nothing goes beside the map.
  std::optional<std::filesystem::path> camera;        ///< Where it was refined, or its response estimated.
  std::vector<std::string> parts;
  bool has_joint_covariance = false;
};

/// Notes in all maps of `result` where they come from, and writes them with the observations they rest on.
/// camera: the file that was read. The page and the joint covariance are among them where they were asked
/// for.
CalibrationFiles write_calibration(const CalibrateOptions& options, const std::filesystem::path& camera,
                                   const Sightings& sightings, const TagSizes& sizes,
                                   const ResponseFindings& responses,
                                   const std::optional<RefinementResult>& refinement,
                                   const CalibrationFindings& findings, const std::string& command_line,
                                   CalibrationResult& result);

}  // namespace apriltrack::app
