#include "track_options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <vector>

#include "apriltrack/base/error.h"
#include "apriltrack/io/lower_case.h"
#include "cli/option_checks.h"
#include "files/format_choice.h"
#include "files/topics.h"

namespace apriltrack::app {
namespace {

constexpr const char* kMcapName = "mcap";

std::vector<std::string> names_of_output_formats() {
  std::vector<std::string> names;
  for (const TrajectoryFormatInfo& info : trajectory_formats()) names.emplace_back(info.name);
  names.emplace_back(kMcapName);
  return names;
}

}  // namespace

MethodOptions TrackArguments::method_options() const {
  MethodOptions given = options;
  given.name = method();
  given.localizer.mode = mode == "joint" ? TrackMode::kJoint : TrackMode::kEgo;
  return given;
}

bool TrackArguments::writes_mcap() const {
  return output_format.empty() ? lower_case_ending(output) == ".mcap" : output_format == kMcapName;
}

TrajectoryFormat TrackArguments::trajectory_format() const {
  const auto format =
      output_format.empty() ? trajectory_format_of_ending(output) : trajectory_format_named(output_format);
  return format.value_or(TrajectoryFormat::kTum);
}

void add_track_options(CLI::App& command, TrackArguments& arguments) {
  command.add_option(
      "INPUT", arguments.input,
      "Sequence folder, folder of images, glob, EuRoC mav0 folder, video file, bag, camera:N, or - for "
      "a pipe");
  command.add_option("--detections", arguments.detections, "detections.csv in place of INPUT");
  command.add_option("--camera", arguments.camera,
                     "Camera file; default: the sequence folder's own, or what a bag says of its camera");
  command.add_option("--camera-name", arguments.camera_name,
                     "Which camera of a file, or of a EuRoC recording, with several; default: the first");
  command.add_option(
      "--map", arguments.map,
      "Tag map, or layout of another project (see `map convert`); default: the sequence folder's own");
  add_map_input_options(command, arguments.map_input);
  command.add_option("--mode", arguments.mode, "ego: T_world_camera; joint: T_camera_body")
      ->check(CLI::IsMember({"ego", "joint"}))
      ->capture_default_str();
  command
      .add_option(
          "--method", arguments.options.name,
          "blur: tracks through motion blur, the default; paper: the seed paper's particle filter, as a "
          "baseline; pnp: detection plus multi-tag PnP, the default of --detections")
      ->check(CLI::IsMember({"blur", "paper", "pnp"}));
  command
      .add_option("--paper-variant", arguments.options.paper_variant,
                  "Of --method paper: as printed, or as its author's program runs")
      ->check(CLI::IsMember({"printed", "program"}))
      ->capture_default_str();
  command
      .add_option(
          "--particles", arguments.options.num_particles,
          "Of --method blur (default: 240 in each of five rounds) and paper (3000 printed, 6000 program)")
      ->check(whole_number(1, 10'000'000));
  command
      .add_option("--seed", arguments.options.seed,
                  "Of --method blur and paper: the same seed gives the same trajectory")
      ->check(seed())
      ->capture_default_str();
  command
      .add_option("--output", arguments.output,
                  "Trajectory: TUM's lines (timestamp tx ty tz qx qy qz qw); in a .csv EuRoC's, in a .kitti "
                  "KITTI's, with the times beside it; a .mcap is the whole run for Foxglove; - is "
                  "stdout, TUM's lines as soon as each pose is known")
      ->required();
  command.add_option("--output-format", arguments.output_format, "Format of --output, whatever its name is")
      ->check(CLI::IsMember(names_of_output_formats()));
  command.add_flag("--output-images", arguments.output_images, "The pictures, too, as JPEG, in an MCAP file");
  command.add_option("--frames-csv", arguments.frames_csv,
                     "Log with a line for every frame: status, pose, covariance");
  command.add_option("--tags-csv", arguments.tags_csv,
                     "Log with a line for every frame and tag in view: what became of it, evidence, corners");
  command.add_option("--video", arguments.video,
                     "The recording with the tags outlined where the poses put them, H.264 in .mp4");
  command.add_option("--report", arguments.report,
                     "Web page about the run, one file: how far it can be trusted, where not, and why");
  add_frame_options(command, arguments.frames);
  add_config_option(command, arguments.config);
  command
      .add_option("--threads", arguments.options.num_threads,
                  "Frames looked at side by side; 0: one per core, 8 at most. Changes no pose, but latencies "
                  "are those of a frame on its own only with 1")
      ->check(threads())
      ->capture_default_str();
  command
      .add_option("--min-margin", arguments.options.localizer.detector.min_decision_margin,
                  "Least decision margin of a tag")
      ->check(decision_margin())
      ->capture_default_str();
  command
      .add_option("--max-hamming", arguments.options.localizer.detector.max_hamming,
                  "Wrong bits that may be corrected, 0 to 2; default: by how often chance reads the family's "
                  "codes (2 for tag36h11, 0 for tag16h5)")
      ->check(corrected_bits());
  command
      .add_option("--decimate", arguments.options.localizer.detector.decimate,
                  "Search in an image this many times smaller: faster, but small tags are missed")
      ->check(decimation())
      ->capture_default_str();
  arguments.console.add_options(command);
}

}  // namespace apriltrack::app
