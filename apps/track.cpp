#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <map>
#include <memory>
#include <numeric>
#include <set>
#include <thread>

#include "apriltrack/base/error.h"
#include "apriltrack/base/parallel.h"
#include "apriltrack/camera/camera.h"
#include "apriltrack/detect/detections_csv.h"
#include "apriltrack/detect/detector.h"
#include "apriltrack/eval/frame_log.h"
#include "apriltrack/eval/trajectory.h"
#include "apriltrack/source/frame_source.h"
#include "apriltrack/tags/tag_map.h"
#include "apriltrack/tracker/localizer.h"
#include "commands.h"
#include "console.h"

namespace apriltrack::app {
namespace {

constexpr const char* kDescription =
    "Localises a camera in a map of tags, or a body of tags before a camera.\n"
    "Example:\n"
    "  apriltrack track recording --camera camera.yaml --map map.yaml --output camera.tum --frames-csv "
    "frames.csv\n"
    "A sequence folder brings its own camera and map:\n"
    "  apriltrack track room_blur --output camera.tum";

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
  Console console;
};

/// What a run leaves behind, frame by frame.
struct Record {
  Trajectory trajectory;
  std::vector<FrameLogRow> rows;
  std::vector<double> latencies_ms;
  std::map<TagKey, int> frames_by_tag;      ///< Everything detected, mapped or not.
  std::map<std::string, int> lost_reasons;  ///< Frames without a pose, by cause.
  std::string first_unreadable;
  int detected = 0;
  int lost = 0;
  int unreadable = 0;
  bool is_interrupted = false;

  void add(const FrameDetections& frame, const TrackResult& result, double latency_s);
  void add_unreadable(const SourceFrame& frame);
};

void Record::add(const FrameDetections& frame, const TrackResult& result, double latency_s) {
  std::set<TagKey> tags;
  for (const Detection& detection : frame.detections) tags.insert(detection.tag);
  for (const TagKey& tag : tags) ++frames_by_tag[tag];
  rows.push_back({.timestamp = result.timestamp,
                  .status = to_string(result.status),
                  .pose = result.pose,
                  .tags_detected = result.tags_detected,
                  .tags_tracked = result.tags_tracked,
                  .latency_ms = 1e3 * latency_s,
                  .second_mode_odds = result.second_mode_odds,
                  .covariance = result.covariance});
  latencies_ms.push_back(1e3 * latency_s);
  if (result.pose) {
    trajectory.push_back({result.timestamp, *result.pose});
    ++detected;
  } else {
    ++lost_reasons[result.reason];
    ++lost;
  }
}

void Record::add_unreadable(const SourceFrame& frame) {
  if (unreadable++ == 0) first_unreadable = frame.name + ": " + frame.error;
  FrameLogRow row;
  row.timestamp = frame.timestamp;
  row.status = to_string(TrackStatus::kUnreadable);
  rows.push_back(row);
}

/// Said before the work and not after it.
void check_folder_of(const std::filesystem::path& output) {
  const auto folder = output.parent_path();
  if (!folder.empty() && !std::filesystem::is_directory(folder)) {
    throw io_error(output.string(), "cannot be written: there is no such folder");
  }
}

void check_arguments(const Arguments& arguments) {
  if (arguments.input.empty() == arguments.detections.empty()) {
    throw invalid_input("track", "give either INPUT or --detections FILE");
  }
  if (arguments.method != "pnp") {
    throw invalid_input("--method",
                        fmt::format("'{}' is not a method of this version; there is: pnp (detection plus "
                                    "multi-tag PnP)",
                                    arguments.method));
  }
  check_folder_of(arguments.output);
  check_folder_of(arguments.frames_csv);
}

/// The option's file, else the sequence folder's own.
std::filesystem::path file_or_default(const std::string& given,
                                      const std::optional<std::filesystem::path>& own,
                                      std::string_view option, std::string_view name) {
  if (!given.empty()) return given;
  if (own) return *own;
  throw invalid_input(option,
                      fmt::format("is required: the input is no sequence folder with a {} of its own", name));
}

Camera load_camera(const Arguments& arguments) {
  const auto path =
      file_or_default(arguments.camera, sequence_camera_file(arguments.input), "--camera", "camera.yaml");
  const CameraRig rig = read_cameras(path);
  return arguments.camera_name.empty() ? rig.cameras.front() : rig.find(arguments.camera_name);
}

TagMap load_map(const Arguments& arguments) {
  return read_tag_map(
      file_or_default(arguments.map, sequence_map_file(arguments.input), "--map", "map.yaml"));
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

void track_detections(const std::vector<FrameDetections>& frames, Localizer& localizer,
                      const Console& console, Record& record) {
  Progress progress(console, "track", frames.size());
  for (const FrameDetections& frame : frames) {
    record.is_interrupted = is_interrupted();
    if (record.is_interrupted) return;
    const TrackResult result = localizer.localize(frame);
    record.add(frame, result, result.latency_s);
    progress.advance();
  }
}

/// Detects in several frames at a time, each thread with a detector of its own; poses follow in the order of
/// time, so that the number of threads changes no result.
class FrameTracker {
 public:
  FrameTracker(const Camera& camera, Localizer& localizer, int num_threads)
      : camera_(camera), localizer_(localizer), parallel_for_(apriltrack::parallel_for(num_threads)) {
    for (int i = 0; i < num_threads; ++i) detectors_.emplace_back(localizer.detector_options());
  }

  void run(FrameSource& source, const Console& console, Record& record) {
    Progress progress(console, "track", source.num_frames());
    while (true) {
      record.is_interrupted = is_interrupted();
      const std::vector<SourceFrame> batch =
          record.is_interrupted ? std::vector<SourceFrame>() : read(source);
      if (batch.empty()) return;
      track(batch, record);
      progress.advance(batch.size());
    }
  }

 private:
  static constexpr std::size_t kFramesPerThread = 4;  // evens out slow frames; a 2 MP frame takes 2 MB

  struct Detected {
    FrameDetections frame;
    double latency_s = 0.0;
  };

  std::vector<SourceFrame> read(FrameSource& source) const {
    std::vector<SourceFrame> batch;
    while (batch.size() < kFramesPerThread * detectors_.size()) {
      auto frame = source.next();
      if (!frame) break;
      if (frame->is_readable()) {
        check_resolution(camera_, frame->pixels.width(), frame->pixels.height(), frame->name);
      }
      batch.push_back(std::move(*frame));
    }
    return batch;
  }

  void track(const std::vector<SourceFrame>& batch, Record& record) {
    std::vector<Detected> detected(batch.size());
    parallel_for_(detectors_.size(), [&](std::size_t thread) {
      for (std::size_t i = thread; i < batch.size(); i += detectors_.size()) {
        if (batch[i].is_readable()) detected[i] = detect(detectors_[thread], batch[i]);
      }
    });
    for (std::size_t i = 0; i < batch.size(); ++i) {
      if (!batch[i].is_readable()) {
        record.add_unreadable(batch[i]);
        continue;
      }
      const TrackResult result = localizer_.localize(detected[i].frame, batch[i].exposure_s);
      record.add(detected[i].frame, result, detected[i].latency_s + result.latency_s);
    }
  }

  Detected detect(Detector& detector, const SourceFrame& frame) const {
    const auto start = std::chrono::steady_clock::now();
    Detected detected;
    detected.frame.timestamp = frame.timestamp;
    detected.frame.camera = camera_.name;
    detected.frame.detections = detector.detect(frame.pixels.view());
    detected.latency_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return detected;
  }

  const Camera& camera_;
  Localizer& localizer_;
  ParallelFor parallel_for_;
  std::vector<Detector> detectors_;
};

int resolved_threads(int num_threads) {
  if (num_threads > 0) return num_threads;
  constexpr int kMaxDefaultThreads = 8;  // every detector holds decoding tables of 38 MB (tag36h11)
  return std::clamp(static_cast<int>(std::thread::hardware_concurrency()), 1, kMaxDefaultThreads);
}

/// "tag36h11/0 to 13, tag16h5/2": sorted keys with runs drawn together.
std::string list_of_tags(const std::set<TagKey>& keys) {
  std::string text;
  for (auto first = keys.begin(); first != keys.end();) {
    auto last = first;
    for (auto next = std::next(last);
         next != keys.end() && next->family == last->family && next->id == last->id + 1; ++next) {
      last = next;
    }
    if (!text.empty()) text += ", ";
    text += to_string(*first);
    if (last != first) text += fmt::format(" to {}", last->id);
    first = std::next(last);
  }
  return text;
}

/// Why a whole recording gave no pose, and what to do.
[[noreturn]] void fail_without_pose(const std::string& input, const TagMap& map, const Record& record) {
  std::set<TagKey> mapped;
  std::set<TagKey> seen;
  std::set<std::string> families;
  for (const MapTag& tag : map.tags) {
    mapped.insert(tag.key);
    families.insert(tag.key.family);
  }
  for (const auto& [key, count] : record.frames_by_tag) seen.insert(key);
  const bool sees_mapped =
      std::any_of(seen.begin(), seen.end(), [&](const TagKey& key) { return mapped.contains(key); });
  const int num_frames = record.detected + record.lost;
  if (num_frames == 0 && record.unreadable > 0) {
    throw io_error(input, fmt::format("none of its {} frames can be read; the first: {}", record.unreadable,
                                      record.first_unreadable));
  }
  if (num_frames == 0) throw no_result(input, "has no frames");
  if (seen.empty()) {
    throw no_result(
        input, fmt::format("no tag of family {} in any of {} frames; is this the family that is printed? "
                           "Are the tags sharp, with a white margin, and 20 px wide or more?",
                           fmt::join(families, ", "), num_frames));
  }
  if (!sees_mapped) {
    throw no_result(
        input, fmt::format("no tag of the map in any of {} frames: seen {}; the map has {}; give the map "
                           "of this place",
                           num_frames, list_of_tags(seen), list_of_tags(mapped)));
  }
  throw no_result(
      input, fmt::format("tags of the map are seen ({}), but in none of {} frames do their corners fit a "
                         "pose; check the tag sizes and poses of the map, and the camera file",
                         list_of_tags(seen), num_frames));
}

double percentile(std::vector<double> values, double fraction) {
  if (values.empty()) return 0.0;
  const auto index = static_cast<std::size_t>(fraction * static_cast<double>(values.size() - 1) + 0.5);
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(index), values.end());
  return values[index];
}

void finish(const Arguments& arguments, const Record& record) {
  if (record.unreadable > 0) {
    arguments.console.warning(
        fmt::format("{} frames cannot be read; the first: {}", record.unreadable, record.first_unreadable));
  }
  if (record.is_interrupted) arguments.console.warning("interrupted: what was done until then is kept");
  const double p50_ms = percentile(record.latencies_ms, 0.50);
  const double p99_ms = percentile(record.latencies_ms, 0.99);
  nlohmann::json summary = {{"frames", record.rows.size()},
                            {"detected", record.detected},
                            {"lost", record.lost},
                            {"unreadable", record.unreadable},
                            {"lost_reasons", record.lost_reasons},
                            {"tags_seen", record.frames_by_tag.size()},
                            {"mode", arguments.mode},
                            {"method", arguments.method},
                            {"latency_p50_ms", p50_ms},
                            {"latency_p99_ms", p99_ms},
                            {"interrupted", record.is_interrupted},
                            {"output", arguments.output}};
  if (!arguments.frames_csv.empty()) summary["frames_csv"] = arguments.frames_csv;
  std::string text = fmt::format(
      "{} frames: {} with a pose, {} lost, {} unreadable; latency {:.1f} ms (p50), {:.1f} ms "
      "(p99)\n{}: {}",
      record.rows.size(), record.detected, record.lost, record.unreadable, p50_ms, p99_ms,
      arguments.mode == "ego" ? "T_world_camera" : "T_camera_body", arguments.output);
  if (!arguments.frames_csv.empty()) text += "\nframe log: " + arguments.frames_csv;
  arguments.console.finish(summary, text);
}

void run(const Arguments& arguments) {
  check_arguments(arguments);
  const Camera camera = load_camera(arguments);
  const TagMap map = load_map(arguments);
  LocalizerOptions options = arguments.localizer;
  options.mode = arguments.mode == "joint" ? TrackMode::kJoint : TrackMode::kEgo;
  Localizer localizer(camera, map, options);

  Record record;
  const std::string input = arguments.input.empty() ? arguments.detections : arguments.input;
  if (!arguments.detections.empty()) {
    track_detections(load_detections(arguments.detections, camera.name), localizer, arguments.console,
                     record);
  } else {
    SourceOptions source_options;
    source_options.rate_hz = arguments.rate_hz;
    const auto source = open_source(arguments.input, source_options);
    FrameTracker(camera, localizer, resolved_threads(arguments.num_threads))
        .run(*source, arguments.console, record);
  }
  if (record.detected == 0) fail_without_pose(input, map, record);
  write_tum(arguments.output, record.trajectory);
  if (!arguments.frames_csv.empty()) write_frame_log(arguments.frames_csv, record.rows);
  finish(arguments, record);
}

}  // namespace

void add_track_command(CLI::App& app) {
  CLI::App& command = *app.add_subcommand("track", kDescription);
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
  command.add_option("--method", arguments->method, "pnp: detection plus multi-tag PnP")
      ->capture_default_str();
  command.add_option("--output", arguments->output, "Trajectory, TUM format: timestamp tx ty tz qx qy qz qw")
      ->required();
  command.add_option("--frames-csv", arguments->frames_csv,
                     "Log with a line for every frame: status, pose, covariance");
  command.add_option("--rate", arguments->rate_hz, "Frames a second, for images whose names are no times")
      ->check(CLI::PositiveNumber);
  command
      .add_option("--threads", arguments->num_threads,
                  "Frames looked at side by side; 0: one per core, 8 at most")
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
