#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "apriltrack/base/error.h"
#include "apriltrack/io/staged_files.h"
#include "command_help.h"
#include "commands.h"
#include "frame_loop.h"
#include "inputs.h"
#include "option_checks.h"
#include "outputs.h"
#include "rig_detections.h"
#include "track_methods.h"
#include "track_record.h"

namespace apriltrack::app {
namespace {

const CommandHelp kTrackHelp = {
    "Localises a camera in a map of tags, or a body of tags before a camera.",
    "apriltrack track recording --camera camera.yaml --map map.yaml --output camera.tum --frames-csv "
    "frames.csv\n"
    "apriltrack track room_blur --output camera.tum",
    "A sequence folder, such as room_blur, brings its own camera and map."};

struct TrackArguments {
  std::string input;
  std::string detections;
  std::string camera;
  std::string camera_name;
  std::string map;
  std::string mode = "ego";
  std::string output;
  std::string frames_csv;
  std::optional<double> rate_hz;
  MethodOptions options;
  Console console;

  /// Corners alone leave nothing but PnP.
  std::string method() const {
    if (!options.name.empty()) return options.name;
    return detections.empty() ? "blur" : "pnp";
  }
};

/// A device or a pipe is no file that one output would take from the other.
bool is_same_file(const std::filesystem::path& a, const std::filesystem::path& b) {
  namespace fs = std::filesystem;
  std::error_code ignored;  // check_output has said what is wrong with the names
  if (fs::exists(a, ignored) && !fs::is_regular_file(a, ignored)) return false;
  return fs::weakly_canonical(a) == fs::weakly_canonical(b);
}

void check_arguments(const CLI::App& command, const TrackArguments& arguments) {
  if (arguments.input.empty() == arguments.detections.empty()) {
    throw invalid_input("track", "give either INPUT or --detections FILE");
  }
  if (!arguments.detections.empty()) {
    if (arguments.method() != "pnp") {
      throw invalid_input("--detections",
                          fmt::format("is for --method pnp: '{}' looks at images", arguments.method()));
    }
    refuse_beside_detections(command, {"--rate", "--decimate", "--min-margin", "--max-hamming"});
  }
  if (!arguments.input.empty()) check_input(arguments.input);
  std::vector<std::string> read = camera_inputs(arguments.camera, {arguments.input});
  read.insert(read.end(), {arguments.input, arguments.detections, arguments.map});
  check_output(arguments.output, "--output", read);
  if (arguments.frames_csv.empty()) return;
  check_output(arguments.frames_csv, "--frames-csv", read);
  if (is_same_file(arguments.frames_csv, arguments.output))
    throw invalid_input("--frames-csv", "is the file of --output: name another");
}

CameraRig load_cameras(const TrackArguments& arguments) {
  return read_cameras(
      file_or_own(arguments.camera, sequence_camera_file(arguments.input), "--camera", "camera.yaml"),
      arguments.console.log());
}

TagMap load_map(const TrackArguments& arguments) {
  return read_tag_map(file_or_own(arguments.map, sequence_map_file(arguments.input), "--map", "map.yaml"));
}

std::vector<FrameDetections> load_detections(const std::string& path, const CameraRig& rig,
                                             const std::string& camera) {
  std::vector<FrameDetections> frames = read_rig_detections(path, rig);
  const std::vector<std::string> there = camera_names(frames);
  std::erase_if(frames, [&](const FrameDetections& frame) { return frame.camera != camera; });
  if (frames.empty() && !there.empty()) {
    throw invalid_input(
        path, fmt::format("has no detections of camera '{}'; it has: {}; choose with --camera-name", camera,
                          fmt::join(there, ", ")));
  }
  return frames;
}

/// Both return whether the user ended them early.
bool track_detections(const TrackArguments& arguments, const std::vector<FrameDetections>& frames,
                      const Method& method, TrackRecord& record) {
  {
    Progress progress(arguments.console, "track", frames.size());
    for (const FrameDetections& frame : frames) {
      if (is_interrupted()) break;
      Frame without_image;
      without_image.timestamp = frame.timestamp;
      const TrackResult result = method.track(without_image, frame.detections);
      record.add(frame, result, result.latency_s);
      progress.advance();
    }
  }
  const bool was_interrupted = record.rows().size() < frames.size();
  if (was_interrupted) arguments.console.warning(kInterrupted);
  return was_interrupted;
}

bool track_images(const TrackArguments& arguments, const Camera& camera, const Method& method,
                  TrackRecord& record) {
  const FrameLoopOptions options{method.detector, &camera, arguments.options.num_threads, "track"};
  const std::unique_ptr<FrameSource> source =
      open_source(arguments.input, {.rate_hz = arguments.rate_hz, .camera_name = arguments.camera_name});
  std::optional<Timestamp> previous;
  std::size_t num_readable = 0;
  const auto track = [&](DetectedFrame detected) {
    const SourceFrame& image = detected.source;
    if (!image.is_readable()) return record.add_unreadable(image.timestamp);
    const auto exposure_s = image.exposure_s ? image.exposure_s : camera.exposure_s;
    if (exposure_s && ++num_readable == 2) check_exposure(*exposure_s, *previous, image.timestamp);
    previous = image.timestamp;
    const FrameDetections frame{image.timestamp, camera.name, std::move(detected.detections)};
    const TrackResult result = method.track(image.frame(), frame.detections);
    record.add(frame, result, detected.latency_s + result.latency_s);
  };
  return detect_frames(*source, options, arguments.console, track).is_interrupted;
}

MethodOptions method_options(const TrackArguments& arguments) {
  MethodOptions options = arguments.options;
  options.name = arguments.method();
  options.localizer.mode = arguments.mode == "joint" ? TrackMode::kJoint : TrackMode::kEgo;
  return options;
}

/// Single tags still give poses in the map of another place: who reads only these would not notice.
void warn_of_contradictions(const TrackRecord& record, const Console& console,
                            std::vector<std::string>& warnings) {
  const auto [frames, without_pose] = record.frames_with_several_tags();
  constexpr std::size_t kFew = 3;
  if (without_pose < kFew || 5 * without_pose < frames) return;
  warnings.push_back(
      fmt::format("in {} of {} frames with several tags these do not agree on a pose: is this the map of "
                  "this place, with the right tag sizes? Poses from single tags cannot tell",
                  without_pose, frames));
  console.warning(warnings.back());
}

void finish(const TrackArguments& arguments, const TrackRecord& record, bool was_interrupted,
            const std::vector<std::string>& warnings) {
  nlohmann::json summary = record.summary();
  summary["mode"] = arguments.mode;
  summary["method"] = arguments.method();
  summary["interrupted"] = was_interrupted;
  summary["warnings"] = warnings;
  summary["output"] = arguments.output;
  std::string text =
      fmt::format("{}\n{}: {}", record.text(), arguments.mode == "ego" ? "T_world_camera" : "T_camera_body",
                  arguments.output);
  if (!arguments.frames_csv.empty()) {
    summary["frames_csv"] = arguments.frames_csv;
    text += "\nframe log: " + arguments.frames_csv;
  }
  arguments.console.finish(summary, text);
}

void run(const CLI::App& command, const TrackArguments& arguments) {
  check_arguments(command, arguments);
  const CameraRig rig = load_cameras(arguments);
  const Camera& camera =
      arguments.camera_name.empty() ? rig.cameras.front() : rig.find(arguments.camera_name);
  const TagMap map = load_map(arguments);
  std::vector<std::string> warnings;
  if (const auto warning = rolling_shutter_warning(camera)) warnings.push_back(*warning);
  for (const std::string& warning : warnings) arguments.console.warning(warning);
  const Method method = make_method(method_options(arguments), camera, map, arguments.console);

  TrackRecord record;
  const bool has_images = arguments.detections.empty();
  std::vector<FrameDetections> detections;
  if (!has_images) detections = load_detections(arguments.detections, rig, camera.name);
  const bool was_interrupted = has_images ? track_images(arguments, camera, method, record)
                                          : track_detections(arguments, detections, method, record);
  warn_of_contradictions(record, arguments.console, warnings);
  record.check_has_pose(has_images ? arguments.input : arguments.detections, map);
  StagedFiles outputs;
  write_tum(outputs.stage(arguments.output), record.trajectory());
  if (!arguments.frames_csv.empty()) write_frame_log(outputs.stage(arguments.frames_csv), record.rows());
  outputs.commit();
  finish(arguments, record, was_interrupted, warnings);
}

}  // namespace

void add_track_command(CLI::App& app) {
  CLI::App& command = add_command(app, "track", kTrackHelp);
  const auto arguments = std::make_shared<TrackArguments>();
  command.add_option("INPUT", arguments->input,
                     "Sequence folder, folder of images, glob, EuRoC mav0 folder, video file, or camera:N");
  command.add_option("--detections", arguments->detections, "detections.csv in place of INPUT");
  command.add_option("--camera", arguments->camera, "Camera file; default: the sequence folder's own");
  command.add_option("--camera-name", arguments->camera_name,
                     "Which camera of a file, or of a EuRoC recording, with several; default: the first");
  command.add_option("--map", arguments->map, "Tag map; default: the sequence folder's own");
  command.add_option("--mode", arguments->mode, "ego: T_world_camera; joint: T_camera_body")
      ->check(CLI::IsMember({"ego", "joint"}))
      ->capture_default_str();
  command
      .add_option(
          "--method", arguments->options.name,
          "blur: tracks through motion blur, the default; paper: the seed paper's particle filter, as a "
          "baseline; pnp: detection plus multi-tag PnP, the default of --detections")
      ->check(CLI::IsMember({"blur", "paper", "pnp"}));
  command
      .add_option("--paper-variant", arguments->options.paper_variant,
                  "Of --method paper: as printed, or as its author's program runs")
      ->check(CLI::IsMember({"printed", "program"}))
      ->capture_default_str();
  command
      .add_option("--particles", arguments->options.num_particles,
                  "Default: 240 in each of five rounds (blur), 3000 (paper, printed), 6000 (paper, program)")
      ->check(CLI::Range(1, 10'000'000));
  command.add_option("--seed", arguments->options.seed, "The same seed gives the same trajectory")
      ->capture_default_str();
  command.add_option("--output", arguments->output, "Trajectory, TUM format: timestamp tx ty tz qx qy qz qw")
      ->required();
  command.add_option("--frames-csv", arguments->frames_csv,
                     "Log with a line for every frame: status, pose, covariance");
  command.add_option("--rate", arguments->rate_hz, "Frames a second, for images whose names are no times")
      ->check(rate());
  command
      .add_option("--threads", arguments->options.num_threads,
                  "Frames looked at side by side; 0: one per core, 8 at most. Changes no pose, but latencies "
                  "are those of a frame on its own only with 1")
      ->check(threads())
      ->capture_default_str();
  command
      .add_option("--min-margin", arguments->options.localizer.detector.min_decision_margin,
                  "Least decision margin of a tag")
      ->check(decision_margin())
      ->capture_default_str();
  command
      .add_option("--max-hamming", arguments->options.localizer.detector.max_hamming,
                  "Most corrected bits of a tag")
      ->check(corrected_bits())
      ->capture_default_str();
  command
      .add_option("--decimate", arguments->options.localizer.detector.decimate,
                  "Search in an image this many times smaller: faster, but small tags are missed")
      ->check(decimation())
      ->capture_default_str();
  arguments->console.add_options(command);
  command.callback([&command, arguments] { run(command, *arguments); });
}

}  // namespace apriltrack::app
