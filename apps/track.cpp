#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <cstdint>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>

#include "apriltrack/base/error.h"
#include "apriltrack/detect/detections_csv.h"
#include "apriltrack/tracker/localizer.h"
#include "apriltrack/tracker/paper_tracker.h"
#include "command_help.h"
#include "commands.h"
#include "frame_loop.h"
#include "inputs.h"
#include "track_record.h"

namespace apriltrack::app {
namespace {

const CommandHelp kHelp = {
    "Localises a camera in a map of tags, or a body of tags before a camera.",
    "apriltrack track recording --camera camera.yaml --map map.yaml --output camera.tum --frames-csv "
    "frames.csv\n"
    "apriltrack track room_blur --output camera.tum",
    "A sequence folder, such as room_blur, brings its own camera and map."};

struct Arguments {
  std::string input;
  std::string detections;
  std::string camera;
  std::string camera_name;
  std::string map;
  std::string mode = "ego";
  std::string method = "pnp";
  std::string output;
  std::string frames_csv;
  std::optional<double> rate_hz;
  int num_threads = 0;
  LocalizerOptions localizer;
  std::string paper_variant = "program";
  std::optional<std::size_t> num_particles;
  std::uint64_t seed = 1;
  Console console;
};

/// A way to track: what it detects with, and what it makes of a frame.
struct Method {
  DetectorOptions detector;
  std::function<TrackResult(const Frame&, const std::vector<Detection>&)> track;
};

void check_arguments(const Arguments& arguments) {
  if (arguments.input.empty() == arguments.detections.empty()) {
    throw invalid_input("track", "give either INPUT or --detections FILE");
  }
  if (arguments.input.empty() && arguments.method != "pnp") {
    throw invalid_input("--detections",
                        fmt::format("is for --method pnp: '{}' looks at images", arguments.method));
  }
  const std::vector<std::string> read = {arguments.input, arguments.detections, arguments.camera,
                                         arguments.map};
  check_output(arguments.output, "--output", read);
  if (arguments.frames_csv.empty()) return;
  check_output(arguments.frames_csv, "--frames-csv", read);
  if (std::filesystem::weakly_canonical(arguments.frames_csv) ==
      std::filesystem::weakly_canonical(arguments.output))
    throw invalid_input("--frames-csv", "is the file of --output: name another");
}

Camera load_camera(const Arguments& arguments) {
  return read_camera(
      file_or_own(arguments.camera, sequence_camera_file(arguments.input), "--camera", "camera.yaml"),
      arguments.camera_name, arguments.console);
}

TagMap load_map(const Arguments& arguments) {
  return read_tag_map(file_or_own(arguments.map, sequence_map_file(arguments.input), "--map", "map.yaml"));
}

/// Frames of one camera; a file with one camera only is taken whatever that is called.
std::vector<FrameDetections> load_detections(const std::string& path, const std::string& camera) {
  std::vector<FrameDetections> frames = read_detections_csv(path);
  std::set<std::string> cameras;
  for (const FrameDetections& frame : frames) cameras.insert(frame.camera);
  if (cameras.size() <= 1) return frames;
  if (!cameras.contains(camera)) {
    throw invalid_input(
        path, fmt::format("has no detections of camera '{}'; it has: {}; choose with --camera-name", camera,
                          fmt::join(cameras, ", ")));
  }
  std::erase_if(frames, [&](const FrameDetections& frame) { return frame.camera != camera; });
  return frames;
}

/// Both return whether the user ended them early.
bool track_detections(const Arguments& arguments, const Camera& camera, const Method& method,
                      TrackRecord& record) {
  const std::vector<FrameDetections> frames = load_detections(arguments.detections, camera.name);
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

bool track_images(const Arguments& arguments, const Camera& camera, const Method& method,
                  TrackRecord& record) {
  const FrameLoopOptions options{method.detector, &camera, arguments.num_threads, "track"};
  const std::unique_ptr<FrameSource> source = open_source(arguments.input, {.rate_hz = arguments.rate_hz});
  const auto track = [&](DetectedFrame detected) {
    const SourceFrame& image = detected.source;
    if (!image.is_readable()) return record.add_unreadable(image.timestamp);
    const FrameDetections frame{image.timestamp, camera.name, std::move(detected.detections)};
    const TrackResult result = method.track(image.frame(), frame.detections);
    record.add(frame, result, detected.latency_s + result.latency_s);
  };
  return detect_frames(*source, options, arguments.console, track).is_interrupted;
}

LocalizerOptions localizer_options(const Arguments& arguments) {
  LocalizerOptions options = arguments.localizer;
  options.mode = arguments.mode == "joint" ? TrackMode::kJoint : TrackMode::kEgo;
  return options;
}

Method pnp_method(const Arguments& arguments, const Camera& camera, const TagMap& map) {
  const auto localizer = std::make_shared<Localizer>(camera, map, localizer_options(arguments));
  return {localizer->detector_options(), [=](const Frame& frame, const std::vector<Detection>& detections) {
            return localizer->localize({frame.timestamp, "", detections}, frame.exposure_s);
          }};
}

Method paper_method(const Arguments& arguments, const Camera& camera, const TagMap& map) {
  const bool is_printed = arguments.paper_variant == "printed";
  auto options = PaperTrackerOptions::published(is_printed ? PaperVariant::kPrinted : PaperVariant::kProgram);
  options.localizer = localizer_options(arguments);
  options.filter.num_particles = arguments.num_particles.value_or(options.filter.num_particles);
  options.filter.seed = arguments.seed;
  options.num_threads = arguments.num_threads;
  const auto tracker = std::make_shared<PaperTracker>(camera, map, options);
  return {tracker->detector_options(), [=](const Frame& frame, const std::vector<Detection>& detections) {
            return tracker->track(frame, detections);
          }};
}

Method make_method(const Arguments& arguments, const Camera& camera, const TagMap& map) {
  if (arguments.method == "paper") return paper_method(arguments, camera, map);
  return pnp_method(arguments, camera, map);
}

void finish(const Arguments& arguments, const TrackRecord& record, bool was_interrupted) {
  nlohmann::json summary = record.summary();
  summary["mode"] = arguments.mode;
  summary["method"] = arguments.method;
  summary["interrupted"] = was_interrupted;
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

void run(const Arguments& arguments) {
  check_arguments(arguments);
  const Camera camera = load_camera(arguments);
  const TagMap map = load_map(arguments);
  const Method method = make_method(arguments, camera, map);

  TrackRecord record;
  const bool has_images = arguments.detections.empty();
  const bool was_interrupted = has_images ? track_images(arguments, camera, method, record)
                                          : track_detections(arguments, camera, method, record);
  record.check_has_pose(has_images ? arguments.input : arguments.detections, map);
  write_tum(arguments.output, record.trajectory());
  if (!arguments.frames_csv.empty()) write_frame_log(arguments.frames_csv, record.rows());
  finish(arguments, record, was_interrupted);
}

}  // namespace

void add_track_command(CLI::App& app) {
  CLI::App& command = add_command(app, "track", kHelp);
  const auto arguments = std::make_shared<Arguments>();
  command.add_option("INPUT", arguments->input,
                     "Sequence folder, folder of images, glob, EuRoC mav0 folder, video file, or camera:N");
  command.add_option("--detections", arguments->detections, "detections.csv in place of INPUT");
  command.add_option("--camera", arguments->camera, "Camera file; default: the sequence folder's own");
  command.add_option("--camera-name", arguments->camera_name,
                     "Which camera of a file with several; default: the first");
  command.add_option("--map", arguments->map, "Tag map; default: the sequence folder's own");
  command.add_option("--mode", arguments->mode, "ego: T_world_camera; joint: T_camera_body")
      ->check(CLI::IsMember({"ego", "joint"}))
      ->capture_default_str();
  command
      .add_option("--method", arguments->method,
                  "pnp: detection plus multi-tag PnP; paper: the seed paper's particle filter, as a baseline")
      ->check(CLI::IsMember({"pnp", "paper"}))
      ->capture_default_str();
  command
      .add_option("--paper-variant", arguments->paper_variant,
                  "Of --method paper: as printed, or as its author's program runs")
      ->check(CLI::IsMember({"printed", "program"}))
      ->capture_default_str();
  command
      .add_option("--particles", arguments->num_particles,
                  "Of --method paper; default: 3000 (printed), 6000 (program)")
      ->check(CLI::Range(1, 10'000'000));
  command.add_option("--seed", arguments->seed, "The same seed gives the same trajectory")
      ->capture_default_str();
  command.add_option("--output", arguments->output, "Trajectory, TUM format: timestamp tx ty tz qx qy qz qw")
      ->required();
  command.add_option("--frames-csv", arguments->frames_csv,
                     "Log with a line for every frame: status, pose, covariance");
  command.add_option("--rate", arguments->rate_hz, "Frames a second, for images whose names are no times")
      ->check(CLI::PositiveNumber);
  command
      .add_option("--threads", arguments->num_threads,
                  "Frames looked at side by side; 0: one per core, 8 at most. Changes no pose, but latencies "
                  "are those of a frame on its own only with 1")
      ->check(CLI::Range(0, 256))
      ->capture_default_str();
  command
      .add_option("--min-margin", arguments->localizer.detector.min_decision_margin,
                  "Least decision margin of a tag")
      ->capture_default_str();
  command
      .add_option("--max-hamming", arguments->localizer.detector.max_hamming, "Most corrected bits of a tag")
      ->capture_default_str();
  command
      .add_option("--decimate", arguments->localizer.detector.decimate,
                  "Search in an image this many times smaller: faster, but small tags are missed")
      ->capture_default_str();
  arguments->console.add_options(command);
  command.callback([arguments] { run(*arguments); });
}

}  // namespace apriltrack::app
