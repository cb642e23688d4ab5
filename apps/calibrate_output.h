#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apriltrack/calib/calibrate_map.h"
#include "calibrate_input.h"
#include "calibrate_options.h"

namespace apriltrack::app {

/// What a calibration leaves on the disk, the map itself aside.
struct CalibrationFiles {
  std::filesystem::path observations;
  std::vector<std::string> parts;
};

/// Notes in all maps of `result` where they come from, and writes them with the observations they rest on.
/// camera: the file that was read.
CalibrationFiles write_calibration(const CalibrateOptions& options, const std::filesystem::path& camera,
                                   const Sightings& sightings, CalibrationResult& result);

/// The answer on stdout.
void tell_calibration(const CalibrateOptions& options, const Sightings& sightings,
                      const CalibrationResult& result, const CalibrationFiles& files);

}  // namespace apriltrack::app
