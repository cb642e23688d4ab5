#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apriltrack/calib/calibrate_map.h"
#include "apriltrack/calib/refine_map.h"
#include "calibrate_input.h"
#include "cli/console.h"
#include "files/frame_options.h"

namespace apriltrack::app {

/// What the command line or --config says.
struct CalibrateOptions {
  std::vector<std::string> inputs;
  std::vector<std::string> detections;
  std::string camera;
  std::string camera_name;
  std::optional<double> tag_size_m;
  std::string tag_sizes;
  std::string held_tag;
  std::string constraints;
  std::string config;
  std::string output;
  std::string parts;
  std::string report;
  std::string joint_covariance;
  int num_threads = 0;
  DetectorOptions detector;
  FrameOptions frames;
  CalibrationOptions calibration;
  RefinementOptions refinement;
  std::optional<double> edge_offset_sigma_px;
  bool no_refine = false;
  bool estimates_response = false;
  Console console;
};

void add_calibrate_options(CLI::App& command, CalibrateOptions& options);

/// Throws Error(kInvalidInput) that names the option, Error(kIo) when the output has no folder to go to.
void check(const CLI::App& command, const CalibrateOptions& options);

/// As the command line has it.
std::string name_of_intrinsics(Intrinsics intrinsics);

/// ID or family/ID as a key; a bare ID is of the family that was seen with it.
TagKey parse_held_tag(const CalibrateOptions& options, const Sightings& sightings);

/// Where the observations go: beside the map; nowhere where that is written to what is no file, such as
/// /dev/null, beside which nobody looks for any.
std::optional<std::filesystem::path> observations_file(const CalibrateOptions& options);
/// Where cameras go if they are refined: beside the map, or nowhere, as the observations.
std::optional<std::filesystem::path> refined_camera_file(const CalibrateOptions& options);
/// Whether a file is one of --detections.
bool is_detections_input(const CalibrateOptions& options, const std::filesystem::path& path);

}  // namespace apriltrack::app
