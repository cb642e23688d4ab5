#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "apriltrack/base/error.h"
#include "apriltrack/camera/auto_response.h"
#include "apriltrack/camera/rolling_shutter.h"
#include "apriltrack/detect/odd_picture_watch.h"
#include "cli/command_help.h"
#include "cli/command_line.h"
#include "cli/commands.h"
#include "exposure_check.h"
#include "files/camera_response.h"
#include "files/corner_claims.h"
#include "files/frame_loop.h"
#include "files/frame_options.h"
#include "files/inputs.h"
#include "files/rig_detections.h"
#include "files/topics.h"
#include "frame_sinks.h"
#include "still_background.h"
#include "track_check.h"
#include "track_methods.h"
#include "track_options.h"
#include "track_outputs.h"
#include "track_record.h"

namespace apriltrack::app {
namespace {

const CommandHelp kTrackHelp = {
    "Localises a camera in a map of tags, or a body of tags before a camera.",
    "apriltrack track recording --camera camera.yaml --map map.yaml --output camera.tum --frames-csv "
    "frames.csv --report report.html\n"
    "apriltrack track room_blur --output camera.tum\n"
    "apriltrack track room_blur --output run.mcap --output-images\n"
    "apriltrack track recording.mcap --topic /camera/image_raw --map map.yaml --output camera.tum",
    "A sequence folder, such as room_blur, brings its own camera and map, a bag with CameraInfo messages "
    "its\n"
    "camera."};

CameraSource camera_of(const TrackArguments& arguments) {
  const auto source = camera_source(arguments.camera, arguments.input, arguments.camera_name);
  if (!source) throw invalid_input("--camera", kNoOwnCamera);
  return *source;
}

std::filesystem::path camera_file(const TrackArguments& arguments) {
  return camera_of(arguments).path;
}

std::filesystem::path map_file(const TrackArguments& arguments) {
  return file_or_own(arguments.map, sequence_map_file(arguments.input), "--map", "map.yaml");
}

std::vector<FrameDetections> load_detections(const std::string& path, const CameraRig& rig,
                                             const std::string& camera, const Console& console) {
  std::vector<FrameDetections> frames = read_rig_detections(path, rig);
  const std::vector<std::string> there = camera_names(frames);
  std::erase_if(frames, [&](const FrameDetections& frame) { return frame.camera != camera; });
  if (frames.empty() && !there.empty()) {
    throw invalid_input(
        path, fmt::format("has no detections of camera '{}'; it has: {}; choose with --camera-name", camera,
                          fmt::join(there, ", ")));
  }
  for (const std::string& warning : check_corner_places(path, rig, frames)) console.warning(warning);
  return frames;
}

/// Both return whether the user ended them early.
bool track_detections(const TrackArguments& arguments, const std::vector<FrameDetections>& frames,
                      const Method& method, const SightContext& context, TrackRecord& record,
                      FrameSinks& sinks) {
  {
    Progress progress(arguments.console, "track", frames.size());
    for (const FrameDetections& frame : frames) {
      if (is_interrupted()) break;
      Frame without_image;
      without_image.timestamp = frame.timestamp;
      const TrackResult result = method.track(without_image, frame.detections);
      record.add(frame, result);
      const std::vector<TagSight> sights = tag_sights(result, frame.detections, context);
      record.add_sights(sights);
      sinks.add(result, sights, nullptr);
      progress.advance();
    }
  }
  const bool was_interrupted = record.rows().size() < frames.size();
  if (was_interrupted) arguments.console.warning(kInterrupted);
  return was_interrupted;
}

SourceOptions source_options(const TrackArguments& arguments, const Camera& camera) {
  SourceOptions options = arguments.frames.source;
  options.camera_name = arguments.camera_name;
  if (!arguments.input.empty())
    options.topic = topic_of(arguments.input, arguments.frames.topics, camera.name, camera_file(arguments),
                             arguments.console);
  set_shutter(options, camera);
  options.log = arguments.console.log();
  return options;
}

/// Where the camera file states none it is told by the map's tags in a sample of the frames.
ResponseFinding find_response(const TrackArguments& arguments, const TagMap& map,
                              const SourceOptions& source_options, Camera& camera) {
  if (!arguments.detections.empty() || camera.response_origin == ResponseOrigin::kStated)
    return {camera.name, camera.response.name(), camera.response_origin};
  DetectorOptions detector = arguments.method_options().localizer.detector;
  std::set<std::string> families;
  TagSizes sizes;
  for (const MapTag& tag : map.tags) {
    families.insert(tag.key.family);
    sizes.set(tag.key, tag.size_m);
  }
  detector.families.assign(families.begin(), families.end());
  detector.camera_model = camera.model;
  const std::vector<SampledInput> inputs = {{arguments.input, source_options}};
  return estimate_by_sample(inputs, detector, sizes, arguments.options.num_threads, arguments.console,
                            camera);
}

bool track_images(const TrackArguments& arguments, const SourceOptions& source_options,
                  const SightContext& context, const Method& method, TrackRecord& record, FrameSinks& sinks) {
  const Camera& camera = context.camera;
  const DetectFramesOptions options{method.detector, &camera, arguments.options.num_threads,
                                    source_options.skip, "track"};
  const std::unique_ptr<FrameSource> source = open_source(arguments.input, source_options);
  const std::string exposure_of_camera =
      fmt::format("{}: {}.exposure_time", camera_file(arguments).string(), camera.name);
  ExposureCheck exposures(arguments.console);
  OddPictureWatch watch;
  StillBackground background(camera, context.map);
  const auto track = [&](DetectedFrame detected) {
    const SourceFrame& image = detected.source;
    if (!image.is_readable()) {
      record.add_unreadable(image.timestamp);
      sinks.add_unreadable(image);
      return;
    }
    if (!detected.is_copy) {  // whose time is no picture's
      if (image.exposure_s)
        exposures.add(image.timestamp, image.exposure_s, image.exposure_where);
      else
        exposures.add(image.timestamp, camera.exposure_s, exposure_of_camera);
    }
    record.searches(image.pixels.width(), arguments.options.localizer.detector.decimate);
    TrackResult result = method.track(image.frame(), detected.detections);
    result.latency_s += detected.latency_s;
    result.detection_s += detected.latency_s;
    const FrameDetections frame{image.timestamp, camera.name,
                                method.detector ? std::move(detected.detections) : result.detections};
    record.were_left_out(method.detector ? detected.left_out : result.left_out);
    watch.add(image.pixels.view(), frame.detections);
    record.add(frame, result, image.exposure_s);
    if (result.pose && result.status == TrackStatus::kDetected)
      background.add(image.timestamp, image.pixels.view(), *result.pose);
    const std::vector<TagSight> sights = tag_sights(result, frame.detections, context);
    record.add_sights(sights);
    sinks.add(result, sights, &image);
  };
  const FrameCounts counts = detect_frames(*source, options, arguments.console, track);
  if (counts.are_all_blank()) record.found_all_blank();
  record.set_value_range(counts.value_range);
  if (const auto odd = is_interrupted() ? std::nullopt : watch.message(method.looks_for))
    record.are_odd(*odd);
  record.found_copies(counts.copies);
  if (const auto told = background.told(); told && arguments.mode == "ego") arguments.console.warning(*told);
  return counts.is_interrupted;
}

/// "tag36h11 3 in 12 frames, tag36h11 5 in 2", the most frequent first.
std::string frames_by_tag(const std::map<TagKey, int>& tags) {
  std::vector<std::pair<TagKey, int>> sorted(tags.begin(), tags.end());
  std::ranges::stable_sort(sorted, [](const auto& a, const auto& b) { return a.second > b.second; });
  constexpr std::size_t kMost = 4;
  std::string text;
  for (std::size_t i = 0; i < std::min(kMost, sorted.size()); ++i)
    text += fmt::format("{}{} in {}", i == 0 ? "" : ", ", to_string(sorted[i].first), sorted[i].second);
  return sorted.size() > kMost ? text + ", ..." : text;
}

/// Single tags still give poses in the map of another place: who reads only these would not notice. And a
/// camera file that is somewhat wrong, or a tag that was moved, gives poses that are surely wrong: right ones
/// left no tag aside in 400 frames of the recordings that we have exact truth of.
void warn_of_contradictions(const TrackRecord& record, const std::string& method, const Console& console) {
  const auto [frames, without_pose, with_strays] = record.frames_with_several_tags();
  constexpr std::size_t kFew = 3;
  if (without_pose >= kFew && 5 * without_pose >= frames) {
    console.warning(fmt::format(
        "in {} of {} frames with several tags these do not agree on a pose, and poses from single "
        "tags cannot tell: is this the map of this place, with the right tag sizes? Is this the "
        "right camera file?",
        without_pose, frames));
  } else if (method != "paper" && with_strays >= kFew && 20 * with_strays >= frames) {
    console.warning(fmt::format(
        "in {} of {} frames with several tags some of these are not where the pose puts them ({}), and "
        "poses may be wrong by more than they claim: is this the right camera file? Was a tag "
        "moved since the map was made?",
        with_strays, frames, frames_by_tag(record.strays())));
  }
}

/// No two tags are read together, and fit, where there are none. Where tags are mostly too blurred to be
/// read, many are tracked.
void warn_of_few_readings(const TrackRecord& record, const TagMap& map, const Console& console) {
  constexpr std::size_t kOneIn = 20;
  const auto num_with = [&](int num_tags) {
    return static_cast<std::size_t>(std::ranges::count_if(
        record.rows(), [&](const FrameLogRow& row) { return row.tags_tracked >= num_tags; }));
  };
  if (!record.has_pose() || num_with(2) > 0 || kOneIn * num_with(1) > record.rows().size()) return;
  if (const std::string doubt = record.doubt_of_readings(map); !doubt.empty()) console.warning(doubt);
}

/// Some hang behind a wall, or a person; where most are not seen, the map tells of another place, or of tags
/// that were taken down.
void warn_of_unseen_tags(const TrackRecord& record, const Console& console) {
  constexpr std::size_t kMany = 10;
  const std::set<TagKey> unseen = record.never_seen_tags();
  if (unseen.size() < kMany || unseen.size() <= record.seen_tags().size()) return;
  console.warning(
      fmt::format("{} tags of the map were in view and never seen, {} were seen: is this the map of this "
                  "place? Were tags "
                  "taken down, or do they hang behind a wall? They were left out",
                  unseen.size(), record.seen_tags().size()));
}

/// Poses do not suffer much, but predictions do, until the motion has told.
void warn_of_exposure(const TrackRecord& record, const Console& console) {
  const std::optional<ExposureReport>& last = record.last_exposure();
  if (!last || !last->is_doubted()) return;
  console.warning(fmt::format(
      "the exposure told, {:.3g} ms, is not what blur and motion show: {:.3g} ms, to {:.0f} %; is "
      "exposure_time right, or exposure_s of frames.csv?",
      1e3 * *last->told_s, 1e3 * last->exposure_s, 100.0 * last->sigma));
}

void run(const CLI::App& command, const TrackArguments& arguments) {
  check_track_arguments(command, arguments);
  tell_of_own_camera(camera_of(arguments), arguments.console);
  const CameraRig rig =
      read_rig(camera_of(arguments), topic_without_camera(arguments.frames.topics), arguments.console).rig;
  const std::string name = camera_name_of(arguments.input, arguments.frames.topics, arguments.camera_name,
                                          camera_file(arguments), arguments.console);
  Camera camera = name.empty() ? rig.cameras.front() : camera_named(rig, name, "--camera-name");
  const TagMap map = read_map_input(map_file(arguments).string(), arguments.map_input, arguments.console);
  if (const auto warning = rolling_shutter_warning(camera)) arguments.console.warning(*warning);
  const SourceOptions of_source = source_options(arguments, camera);
  const ResponseFinding response = find_response(arguments, map, of_source, camera);
  const Method method = make_method(arguments.method_options(), camera, map, arguments.console);

  TrackRecord record;
  const bool has_images = arguments.detections.empty();
  std::vector<FrameDetections> detections;
  if (!has_images) detections = load_detections(arguments.detections, rig, camera.name, arguments.console);
  const CornerClaims claims =
      corner_claims_of_track(detections, arguments.method_options().localizer.corner_sigma_px);
  if (const std::string told = in_words(claims, "the poses"); !told.empty()) arguments.console.info(told);
  FrameSinks sinks(arguments, camera, map);
  const SightContext context{camera, map, arguments.method_options().localizer.mode};
  const bool was_interrupted = has_images
                                   ? track_images(arguments, of_source, context, method, record, sinks)
                                   : track_detections(arguments, detections, method, context, record, sinks);
  if (has_images) tell(response, arguments.console);
  warn_of_contradictions(record, arguments.method(), arguments.console);
  warn_of_few_readings(record, map, arguments.console);
  warn_of_unseen_tags(record, arguments.console);
  warn_of_exposure(record, arguments.console);
  if (record.has_pose() && !record.odd_pictures().empty()) arguments.console.warning(record.odd_pictures());
  const bool with_frame_log = writes_frame_log(arguments, record);
  write_outputs(arguments,
                {command_line_of(command), arguments, camera_file(arguments), map_file(arguments), camera,
                 map, record, response, was_interrupted},
                with_frame_log, sinks);
  if (!record.has_pose())
    throw no_result(has_images ? arguments.input : arguments.detections,
                    record.why_no_pose(map) + told_of_frame_log(arguments, with_frame_log));
  finish(arguments, record, response, claims, was_interrupted);
}

}  // namespace

void add_track_command(CLI::App& app) {
  CLI::App& command = add_command(app, "track", kTrackHelp);
  const auto arguments = std::make_shared<TrackArguments>();
  add_track_options(command, *arguments);
  command.callback([&command, arguments] { run(command, *arguments); });
}

}  // namespace apriltrack::app
