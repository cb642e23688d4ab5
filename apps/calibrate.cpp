#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <ctime>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>

#include "apriltrack/base/error.h"
#include "apriltrack/calib/calibrate_map.h"
#include "apriltrack/detect/detections_csv.h"
#include "apriltrack/io/numbers.h"
#include "calibrate_input.h"
#include "commands.h"
#include "config_file.h"
#include "inputs.h"

namespace apriltrack::app {
namespace {

namespace fs = std::filesystem;

constexpr const char* kDescription =
    "Builds a tag map from images in which tags are seen together.\n"
    "Examples:\n"
    "  apriltrack calibrate video.mp4 --camera camera.yaml --tag-size 0.16 --output map.yaml\n"
    "  apriltrack calibrate --detections detections.csv --camera camera.yaml --tag-sizes tag_sizes.yaml "
    "--output "
    "map.yaml\n"
    "  apriltrack calibrate cam0=left cam1=right --camera rig.yaml --tag-size 0.088 --family tag36h11b2 "
    "--output "
    "map.yaml\n"
    "Film slowly, from many sides, with two or more tags in view; every tag must be linked to the others by "
    "such "
    "frames.";

struct Arguments {
  std::vector<std::string> inputs;
  std::vector<std::string> detections;
  std::string camera;
  std::string camera_name;
  std::optional<double> tag_size_m;
  std::string tag_sizes;
  std::string held_tag;
  std::string config;
  std::string output;
  std::string parts;
  int num_threads = 0;
  DetectorOptions detector;
  SourceOptions source;
  CalibrationOptions calibration;
  Console console;
};

void add_options(CLI::App& command, Arguments& a) {
  command.add_option(
      "input", a.inputs,
      "INPUT: sequence folder, folder of images, glob, EuRoC mav0 folder or video; of several cameras: "
      "cam0=PATH cam1=PATH");
  command.add_option("--detections", a.detections, "Detection file(s) in place of images");
  command.add_option("--camera", a.camera, "Camera file; a sequence folder's own by default");
  command.add_option("--camera-name", a.camera_name, "Use this camera of the file only");
  command.add_option(
      "--tag-size", a.tag_size_m,
      "Edge length in metres of the square whose corners are detected (tag36h11: the outer edge of the "
      "black border), for tags that --tag-sizes does not name");
  command.add_option("--tag-sizes", a.tag_sizes, "YAML file with sizes by id");
  command.add_option("--family", a.detector.families, "Tag family; may be given several times")
      ->allow_extra_args(false)
      ->capture_default_str();
  command.add_option("--decimate", a.detector.decimate, "Search tags in an image this many times smaller")
      ->capture_default_str();
  command.add_option(
      "--held-tag,--origin", a.held_tag,
      "Tag at the map's origin, ID or family/ID; by default the first one of the largest part");
  command
      .add_option("--min-views", a.calibration.min_views,
                  "Leave out tags seen in fewer frames together with others")
      ->capture_default_str();
  command.add_option("--map-frame", a.calibration.map_frame, "Name of the map's frame")
      ->capture_default_str();
  command.add_option("--rate", a.source.rate_hz, "Frames a second, for images whose names are no times");
  command.add_option("--step", a.source.step, "Use every STEP-th frame")->capture_default_str();
  command.add_option("--max-frames", a.source.max_frames, "Use so many frames of each input at most");
  command.add_option("--parts", a.parts, "Folder for a map of each part: part_1.yaml is the map itself");
  command.add_option("--config", a.config,
                     "YAML file of options, keys = their long names; the command line wins");
  command.add_option("--output", a.output,
                     "The map; its observations go to <output>.detections.csv beside it");
  command.add_option("--threads", a.num_threads, "0 = as many as there are cores; changes no result")
      ->capture_default_str();
  a.console.add_options(command);
}

void check_arguments(const Arguments& a) {
  if (a.output.empty()) throw invalid_input("--output", "is required: where to write the map");
  if (a.inputs.empty() == a.detections.empty())
    throw invalid_input("calibrate", a.inputs.empty() ? "give an INPUT or --detections FILE"
                                                      : "give either INPUT or --detections, not both");
  if (!a.tag_size_m && a.tag_sizes.empty())
    throw invalid_input("--tag-size",
                        "is required (or --tag-sizes FILE): the edge in metres of the square whose "
                        "corners are detected; for tag36h11 the outer edge of the black border");
  if (a.tag_size_m && !(*a.tag_size_m > 0.0 && *a.tag_size_m <= 100.0))
    throw invalid_input("--tag-size", fmt::format("must be in (0, 100] metres (is {})", *a.tag_size_m));
  if (a.num_threads < 0)
    throw invalid_input("--threads", fmt::format("must be 0 or more (is {})", a.num_threads));
  if (a.source.step < 1) throw invalid_input("--step", "must be 1 or more (is 0)");
  if (a.source.rate_hz && !(*a.source.rate_hz > 0.0 && *a.source.rate_hz <= 1e6))
    throw invalid_input("--rate",
                        fmt::format("must be in (0, 1e6] frames a second (is {})", *a.source.rate_hz));
  a.detector.check();
  a.calibration.check();
  check_folder_of(a.output);
}

fs::path camera_file(const Arguments& a) {
  if (!a.camera.empty()) return a.camera;
  for (const std::string& input : a.inputs) {
    const auto own = sequence_camera_file(input.substr(input.find('=') + 1));  // npos + 1 is 0
    if (own) return *own;
  }
  throw invalid_input("--camera",
                      "is required: the input is no sequence folder with a camera.yaml of its own");
}

TagSizes tag_sizes(const Arguments& a) {
  return a.tag_sizes.empty() ? TagSizes(a.tag_size_m) : read_tag_sizes(a.tag_sizes, a.tag_size_m);
}

/// ID or family/ID. A bare ID is of the family that was seen with it.
TagKey parse_held_tag(const std::string& text, const Arguments& a, const Sightings& sightings) {
  const std::size_t slash = text.find('/');
  const auto id = parse_integer(slash == std::string::npos ? text : text.substr(slash + 1));
  if (!id || *id < 0)
    throw invalid_input("--held-tag", fmt::format("must be ID or family/ID (is '{}')", text));
  if (slash != std::string::npos) return {text.substr(0, slash), static_cast<int>(*id)};
  std::set<std::string> families;
  for (const FrameDetections& frame : sightings.frames) {
    for (const Detection& detection : frame.detections) {
      if (detection.tag.id == *id) families.insert(detection.tag.family);
    }
  }
  if (families.size() > 1)
    throw invalid_input("--held-tag", fmt::format("id {} was seen of several families ({}); say family/ID",
                                                  *id, fmt::join(families, ", ")));
  return {families.empty() ? a.detector.families.front() : *families.begin(), static_cast<int>(*id)};
}

Sightings gather(const Arguments& a, const CameraRig& rig) {
  if (!a.detections.empty()) return read_sightings(a.detections, rig, a.camera_name);
  return detect_in(parse_recordings(a.inputs, rig, a.camera_name), rig, a.detector, a.source, a.num_threads,
                   a.console);
}

std::vector<std::pair<std::string, std::string>> provenance(const Arguments& a, const fs::path& camera,
                                                            const TagKey& held,
                                                            const fs::path& observations) {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  const auto& inputs = a.detections.empty() ? a.inputs : a.detections;
  return {{"tool", "apriltrack " APRILTRACK_VERSION},
          {"date", fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", utc)},
          {"inputs", fmt::format("{}", fmt::join(inputs, ", "))},
          {"camera", camera.string() + (a.camera_name.empty() ? "" : " " + a.camera_name)},
          {"options",
           fmt::format("family {}; tag size {}; sizes file {}; min views {}; step {}",
                       fmt::join(a.detector.families, " "), a.tag_size_m ? format_exact(*a.tag_size_m) : "-",
                       a.tag_sizes.empty() ? "-" : a.tag_sizes, a.calibration.min_views, a.source.step)},
          {"gauge", to_string(held) + " held at the origin"},
          {"observations", observations.filename().string()}};
}

/// A side file that is itself an input stays as it is: it may hold more than was used.
bool is_input(const Arguments& a, const fs::path& path) {
  return std::any_of(a.detections.begin(), a.detections.end(), [&](const std::string& input) {
    std::error_code ignored;
    return fs::equivalent(input, path, ignored);
  });
}

void write_observations(const Arguments& a, const Sightings& sightings, const fs::path& path) {
  if (is_input(a, path)) return;
  std::vector<FrameDetections> frames = sightings.frames;
  std::stable_sort(frames.begin(), frames.end(), [](const FrameDetections& x, const FrameDetections& y) {
    return std::tie(x.timestamp, x.camera) < std::tie(y.timestamp, y.camera);
  });
  write_detections_csv(path, frames);
}

std::vector<std::string> write_parts(const Arguments& a, const CalibrationResult& result) {
  std::vector<std::string> written;
  if (a.parts.empty()) return written;
  std::error_code error;
  fs::create_directories(a.parts, error);
  if (error) throw io_error(a.parts, error.message());
  std::vector<const TagMap*> maps = {&result.map};
  for (const TagMap& part : result.other_parts) maps.push_back(&part);
  for (std::size_t i = 0; i < maps.size(); ++i) {
    written.push_back((fs::path(a.parts) / fmt::format("part_{}.yaml", i + 1)).string());
    write_tag_map(written.back(), *maps[i]);
  }
  return written;
}

nlohmann::json names(const std::vector<TagKey>& keys) {
  nlohmann::json list = nlohmann::json::array();
  for (const TagKey& key : keys) list.push_back(to_string(key));
  return list;
}

nlohmann::json names(const TagMap& map) {
  nlohmann::json list = nlohmann::json::array();
  for (const MapTag& tag : map.tags) list.push_back(to_string(tag.key));
  return list;
}

void finish(const Arguments& a, const Sightings& sightings, const CalibrationResult& result,
            const fs::path& observations, const std::vector<std::string>& part_files) {
  nlohmann::json other_parts = nlohmann::json::array();
  for (const TagMap& part : result.other_parts) other_parts.push_back(names(part));
  const nlohmann::json summary = {{"tags", names(result.map)},
                                  {"held_tag", to_string(result.held_tag)},
                                  {"frames", sightings.counts.readable},
                                  {"frames_unreadable", sightings.counts.unreadable},
                                  {"frames_used", result.frames_used},
                                  {"observations_used", result.observations_used},
                                  {"observations_rejected", result.observations_rejected},
                                  {"residual_rms_px", result.residual_rms_px},
                                  {"left_out", names(result.left_out)},
                                  {"other_parts", other_parts},
                                  {"part_files", part_files},
                                  {"warnings", result.warnings},
                                  {"interrupted", sightings.counts.is_interrupted},
                                  {"output", a.output},
                                  {"observations", observations.string()}};
  std::string text = fmt::format(
      "{} tags from {} of {} frames ({} unreadable); {} observations, {} rejected; residual {:.3f} px (rms "
      "per axis)\n"
      "origin: {}\nmap: {}\nobservations: {}",
      result.map.tags.size(), result.frames_used, sightings.counts.readable, sightings.counts.unreadable,
      result.observations_used, result.observations_rejected, result.residual_rms_px,
      to_string(result.held_tag), a.output, observations.string());
  for (const std::string& file : part_files) text += "\npart: " + file;
  a.console.finish(summary, text);
}

void run(CLI::App& command, Arguments& a) {
  if (!a.config.empty()) apply_config_file(command, a.config);
  check_arguments(a);
  const fs::path camera = camera_file(a);
  const CameraRig rig = read_cameras(camera, a.console.log());
  const TagSizes sizes = tag_sizes(a);
  const Sightings sightings = gather(a, rig);

  a.calibration.num_threads = a.num_threads;
  if (!a.held_tag.empty()) a.calibration.held_tag = parse_held_tag(a.held_tag, a, sightings);
  CalibrationResult result = calibrate_map(sightings.frames, rig, sizes, a.calibration, a.console.log());
  for (const std::string& warning : result.warnings) a.console.warning(warning);

  const fs::path observations = fs::path(a.output).replace_extension(".detections.csv");
  result.map.provenance = provenance(a, camera, result.held_tag, observations);
  for (TagMap& part : result.other_parts)
    part.provenance = provenance(a, camera, part.tags.front().key, observations);
  write_observations(a, sightings, observations);
  const std::vector<std::string> part_files = write_parts(a, result);
  write_tag_map(a.output, result.map);
  finish(a, sightings, result, observations, part_files);
}

}  // namespace

void add_calibrate_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("calibrate", kDescription);
  auto arguments = std::make_shared<Arguments>();
  add_options(*command, *arguments);
  command->callback([command, arguments] { run(*command, *arguments); });
}

}  // namespace apriltrack::app
