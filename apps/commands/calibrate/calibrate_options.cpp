#include "calibrate_options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <limits>
#include <set>

#include "apriltrack/base/error.h"
#include "apriltrack/io/staged_files.h"
#include "apriltrack/tags/tag_key_fault.h"
#include "cli/choice_option.h"
#include "cli/option_checks.h"
#include "files/inputs.h"
#include "files/outputs.h"
#include "files/topics.h"

namespace apriltrack::app {
namespace fs = std::filesystem;

namespace {

/// What is looked at, and how.
void add_input_options(CLI::App& command, CalibrateOptions& a) {
  command.add_option(
      "INPUT", a.inputs,
      "Sequence folder, folder of images, glob, EuRoC mav0 folder, video or bag; of several cameras: "
      "cam0=PATH cam1=PATH");
  command.add_option("--detections", a.detections, "Detection file(s) in place of images");
  command.add_option("--camera", a.camera,
                     "Camera file; by default a sequence folder's own, or what a bag says of its camera");
  command.add_option("--camera-name", a.camera_name, "Use this camera of the file only");
  command.add_option(
      "--tag-size", a.tag_size_m,
      "Edge length in metres of the square whose corners are detected (tag36h11: the outer edge of the "
      "black border), for tags that --tag-sizes does not name");
  command.add_option("--tag-sizes", a.tag_sizes, "YAML file with sizes by id");
  command.add_option("--family", a.detector.families, "Tag family; may be given several times")
      ->allow_extra_args(false)
      ->check(known_family())
      ->capture_default_str();
  command.add_option("--decimate", a.detector.decimate, "Search tags in an image this many times smaller")
      ->check(decimation())
      ->capture_default_str();
  add_frame_options(command, a.frames);
}

/// What is taken as known, and what is solved for.
void add_model_options(CLI::App& command, CalibrateOptions& a) {
  command.add_option(
      "--held-tag,--origin", a.held_tag,
      "Tag at the map's origin, ID or family/ID; by default the first one of the largest part");
  command.add_option("--constraints", a.constraints,
                     "YAML file of what is known beside the images: distances, measured coordinates, boards, "
                     "planes, upright tags, floor, gravity; each with its sigma");
  command
      .add_option(
          "--min-views", a.calibration.min_views,
          "Leave out tags seen in fewer frames together with others; frames taken from one place count once")
      ->check(whole_number(1, 1'000'000'000))
      ->capture_default_str();
  command.add_option("--map-frame", a.calibration.map_frame, "Name of the map's frame")
      ->check(not_empty("name the map's frame, such as world"))
      ->capture_default_str();
  command.add_flag("--no-refine", a.no_refine,
                   "Leave the map as the corners say, and do not refine it on the tags' pictures");
  add_choice<Intrinsics>(
      command, "--intrinsics", a.calibration.intrinsics,
      {{"keep", Intrinsics::kKeep}, {"auto", Intrinsics::kAuto}, {"refine", Intrinsics::kRefine}},
      "Of the camera file: keep; refine with the map where held-out frames agree better; or auto: "
      "refine only where it is clearly wrong. A refined camera goes to <output>.camera.yaml");
  add_choice<bool>(
      command, "--response", a.estimates_response, {{"keep", false}, {"auto", true}},
      "Of the cameras: keep what the camera file says, and estimate from the images what it does not "
      "say; or auto: estimate all, as `response: auto` in the file does. It goes to "
      "<output>.camera.yaml");
  add_choice<bool>(command, "--extrinsics", a.calibration.refine_extrinsics,
                   {{"keep", false}, {"refine", true}},
                   "Where several cameras sit on the rig: keep, or refine");
  command
      .add_option("--edge-offset-sigma", a.edge_offset_sigma_px,
                  "How far (px) the detector's edges may lie beside the true ones: estimated with the map; "
                  "0 = not at all. 0.2 for --detections, 0 for images")
      ->check(number_between(0.0, 100.0));
}

/// What is written.
void add_output_options(CLI::App& command, CalibrateOptions& a) {
  command.add_option("--parts", a.parts, "Folder for a map of each part: part_1.yaml is the map itself");
  command.add_option("--report", a.report,
                     "Web page: how far the map can be trusted, where not, and what would help; with "
                     "--cross-validate");
  command.add_flag("--cross-validate", a.calibration.cross_validate,
                   "Make a map of each half of the recording, too, and say how far the two differ");
  command.add_option("--joint-covariance", a.joint_covariance,
                     "YAML file for the covariance of all tags together, from which follows that of any two");
  command.add_option("--output", a.output,
                     "The map; its observations go to <output>.detections.csv beside it");
}

}  // namespace

void add_calibrate_options(CLI::App& command, CalibrateOptions& a) {
  add_input_options(command, a);
  add_model_options(command, a);
  add_output_options(command, a);
  add_config_option(command, a.config);
  command.add_option("--threads", a.num_threads, "0 = as many as there are cores; changes no result")
      ->check(threads())
      ->capture_default_str();
  a.console.add_options(command);
}

namespace {

/// The observations that a map is made from lie beside it. Where they are the very file that it is made from,
/// that stays as it is; one file of several would be told to be all of them.
std::string observations_to_write(const CalibrateOptions& a) {
  const std::optional<fs::path> beside = observations_file(a);
  if (!beside) return "";
  const std::string file = beside->string();
  if (!is_detections_input(a, file)) return file;
  if (a.detections.size() == 1) return "";
  throw invalid_input("--output", fmt::format("the observations would go to '{}', which is one of several "
                                              "--detections: name another file",
                                              file));
}

/// Whether cameras are refined shows only after the work.
std::string camera_to_write(const CalibrateOptions& a, const std::vector<std::string>& read) {
  if (a.calibration.intrinsics == Intrinsics::kKeep && !a.calibration.refine_extrinsics &&
      !a.estimates_response)
    return "";
  const std::optional<fs::path> beside = refined_camera_file(a);
  if (!beside) return "";
  const std::string file = beside->string();
  const bool is_read = std::ranges::any_of(read, [&](const std::string& input) {
    std::error_code ignored;
    return fs::equivalent(input, file, ignored);
  });
  if (!is_read) return file;
  throw invalid_input("--output",
                      fmt::format("a refined camera would replace '{}', which this run reads: name another "
                                  "file, or give --intrinsics keep{}",
                                  file, a.calibration.refine_extrinsics ? " --extrinsics keep" : ""));
}

/// How many parts there will be shows only after the work: nothing else may have the name of any.
bool is_named_as_part(const fs::path& file, const fs::path& parts) {
  std::error_code ignored;
  return file.extension() == ".yaml" && file.filename().string().starts_with("part_") &&
         fs::weakly_canonical(fs::absolute(file), ignored).parent_path() ==
             fs::weakly_canonical(fs::absolute(parts) / "part_1.yaml", ignored).parent_path();
}

void check_parts(const CalibrateOptions& a, const std::vector<std::string>& read) {
  if (a.parts.empty()) return;
  std::error_code ignored;
  if (fs::exists(a.parts, ignored) && !fs::is_directory(a.parts, ignored))
    throw invalid_input("--parts", fmt::format("'{}' is a file: name a folder", a.parts));
  check_output_folder(a.parts);
  if (is_named_as_part(a.output, a.parts))
    throw invalid_input("--output",
                        fmt::format("'{}' has the name of a part in --parts: name another file", a.output));
  for (const std::string& input : read) {
    if (is_named_as_part(input, a.parts))
      throw invalid_input(
          "--parts",
          fmt::format("a part would replace '{}', which this run reads: name another folder", input));
  }
}

void check_files(const CalibrateOptions& a, const std::vector<std::string>& read) {
  const std::string observations = observations_to_write(a), camera = camera_to_write(a, read);
  check_outputs({{a.output, "--output"},
                 {observations, "--output (its observations)"},
                 {camera, "--output (its refined camera)"},
                 {a.report, "--report"},
                 {a.joint_covariance, "--joint-covariance"}},
                read);
  check_parts(a, read);
}

/// As it is written: without a family where that is left to what is seen. Said before the work: a tag that is
/// none is never seen, and what was seen instead does not tell why.
TagKey written_held_tag(const std::string& text) {
  const auto key = parse_tag_key(text);
  if (!key)
    throw invalid_input("--held-tag", fmt::format("must be ID or family/ID, ID from 0 to {} (is '{}')",
                                                  std::numeric_limits<int>::max(), text));
  const auto fault = text.find('/') == std::string::npos ? std::nullopt : fault_of_key(*key);
  if (fault) throw invalid_input("--held-tag", fmt::format("'{}' is no tag: {}", text, *fault));
  return *key;
}

}  // namespace

void check(const CLI::App& command, const CalibrateOptions& a) {
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
  if (!a.detections.empty()) {
    refuse_beside_detections(command, kFrameOptionNames);
    refuse_beside_detections(command, {"--family", "--decimate", "--no-refine", "--response"});
  }
  check_families(a.detector.families);
  if (!a.held_tag.empty()) written_held_tag(a.held_tag);
  a.detector.check();
  a.calibration.check();
  std::vector<std::string> inputs;
  for (const std::string& input : a.inputs) {
    inputs.push_back(split_input(input).input);
    refuse_pipe(inputs.back());
    check_input(inputs.back());
  }
  std::vector<std::string> read = camera_inputs(a.camera, inputs);
  read.insert(read.end(), {a.tag_sizes, a.constraints, a.config});
  read.insert(read.end(), inputs.begin(), inputs.end());
  read.insert(read.end(), a.detections.begin(), a.detections.end());
  check_files(a, read);
}

std::string name_of_intrinsics(Intrinsics intrinsics) {
  switch (intrinsics) {
    case Intrinsics::kKeep:
      return "keep";
    case Intrinsics::kAuto:
      return "auto";
    case Intrinsics::kRefine:
      return "refine";
  }
  return "";
}

TagKey parse_held_tag(const CalibrateOptions& a, const Sightings& sightings) {
  const TagKey written = written_held_tag(a.held_tag);
  if (!written.family.empty()) return written;
  std::set<std::string> families;
  for (const FrameDetections& frame : sightings.frames) {
    for (const Detection& detection : frame.detections) {
      if (detection.tag.id == written.id) families.insert(detection.tag.family);
    }
  }
  if (families.size() > 1)
    throw invalid_input("--held-tag", fmt::format("id {} was seen of several families ({}); say family/ID",
                                                  written.id, fmt::join(families, ", ")));
  return {families.empty() ? a.detector.families.front() : *families.begin(), written.id};
}

std::optional<fs::path> observations_file(const CalibrateOptions& a) {
  if (is_written_directly(a.output)) return std::nullopt;
  return fs::path(a.output).replace_extension(".detections.csv");
}

std::optional<fs::path> refined_camera_file(const CalibrateOptions& a) {
  if (is_written_directly(a.output)) return std::nullopt;
  return fs::path(a.output).replace_extension(".camera.yaml");
}

bool is_detections_input(const CalibrateOptions& a, const fs::path& path) {
  return std::any_of(a.detections.begin(), a.detections.end(), [&](const std::string& input) {
    std::error_code ignored;
    return fs::equivalent(input, path, ignored);
  });
}

}  // namespace apriltrack::app
