#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "apriltrack/base/error.h"
#include "apriltrack/calib/calibrate_map.h"
#include "apriltrack/calib/refine_map.h"
#include "apriltrack/camera/auto_response.h"
#include "apriltrack/camera/rolling_shutter.h"
#include "apriltrack/detect/picture_size.h"
#include "apriltrack/io/yaml_reader.h"
#include "calibrate_camera.h"
#include "calibrate_input.h"
#include "calibrate_options.h"
#include "calibrate_output.h"
#include "calibrate_report.h"
#include "calibrate_response.h"
#include "calibrate_summary.h"
#include "cli/command_help.h"
#include "cli/command_line.h"
#include "cli/commands.h"
#include "cli/failure.h"
#include "cli/replaced_pattern.h"
#include "files/blank_images.h"
#include "files/corner_claims.h"
#include "files/inputs.h"
#include "files/topics.h"
#include "option_hints.h"
#include "pages/constraint_table.h"

namespace apriltrack::app {
namespace {

const CommandHelp kCalibrateHelp = {
    "Builds a tag map from images in which tags are seen together.",
    "apriltrack calibrate video.mp4 --camera camera.yaml --tag-size 0.16 --output map.yaml\n"
    "apriltrack calibrate --detections detections.csv --camera camera.yaml --tag-sizes tag_sizes.yaml "
    "--output map.yaml\n"
    "apriltrack calibrate video.mp4 --camera camera.yaml --tag-size 0.16 --constraints measured.yaml "
    "--output map.yaml\n"
    "apriltrack calibrate cam0=left cam1=right --camera rig.yaml --tag-size 0.088 --family tag36h11b2 "
    "--output map.yaml\n"
    "apriltrack calibrate recording.mcap --topic cam0=/left/image_raw --topic cam1=/right/image_raw --camera "
    "rig.yaml --tag-size 0.16 --output map.yaml",
    "Film slowly, from many sides, with two or more tags in view; every tag must be linked to the others by\n"
    "such frames."};

/// Other detectors, and images that were not brought to linear light, put edges 0.1 to 0.4 px inside the true
/// ones; our own on images in linear light, 0.003 px.
constexpr double kForeignEdgeOffset_px = 0.2;

TagSizes tag_sizes(const CalibrateOptions& a) {
  return a.tag_sizes.empty() ? TagSizes(a.tag_size_m) : read_tag_sizes(a.tag_sizes, a.tag_size_m);
}

Sightings gather(const CalibrateOptions& a, const CameraRig& rig, const std::vector<Recording>& recordings) {
  if (!a.detections.empty()) return read_sightings(a.detections, rig, a.camera_name);
  const bool is_response_open = std::ranges::any_of(
      rig.cameras, [](const Camera& camera) { return camera.response_origin == ResponseOrigin::kAssumed; });
  const bool with_patches = !a.no_refine || is_response_open;
  return detect_in(recordings, rig, a.detector, a.frames.source, a.num_threads, with_patches, a.console);
}

/// An id mistyped in the file leaves the tag that was meant with another size, and nothing else tells of it.
void warn_of_unseen_sizes(const CalibrateOptions& a, const Sightings& sightings) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(a.tag_sizes, ignored)) return;  // a pipe cannot be read again
  if (sightings.counts.is_interrupted) return;
  std::set<TagKey> tags;
  for (const FrameDetections& frame : sightings.frames)
    for (const Detection& detection : frame.detections) tags.insert(detection.tag);
  std::set<std::string> seen;  // by both names that the file may have for a tag
  for (const TagKey& tag : tags) seen.insert({std::to_string(tag.id), to_string(tag)});
  const auto named = YamlNode::read_file(a.tag_sizes).find("sizes");
  if (seen.empty() || !named) return;
  constexpr std::size_t kMostNamed = 10;
  std::vector<std::string> unseen;
  std::size_t others = 0;
  for (const auto& [name, size] : named->entries()) {
    if (seen.contains(name)) continue;
    if (unseen.size() < kMostNamed) {
      unseen.push_back(fmt::format("{} ({})", name, size.where()));
    } else {
      ++others;
    }
  }
  if (unseen.empty()) return;
  a.console.warning(fmt::format(
      "--tag-sizes names tags that were never seen, whose sizes change nothing: {}{}; is an id or "
      "family mistyped?",
      fmt::join(unseen, ", "), others > 0 ? fmt::format(" and {} more", others) : ""));
}

/// Of the cameras that may take part.
void warn_of_shutters(const CameraRig& rig, const std::string& camera_name,
                      const std::vector<Recording>& recordings, const Console& console) {
  for (const Camera& camera : rig.cameras) {
    const bool is_filmed = std::any_of(recordings.begin(), recordings.end(),
                                       [&](const Recording& r) { return r.camera == camera.name; });
    const bool takes_part =
        recordings.empty() ? camera_name.empty() || camera_name == camera.name : is_filmed;
    if (!takes_part) continue;
    if (const auto warning = rolling_shutter_warning(camera)) console.warning(*warning);
  }
}

/// Warnings of calibrate_map that were given with file and line.
std::set<std::string> told_already(const Sightings& sightings, const CameraRig& rig) {
  CameraRig of_told;
  for (const std::string& camera : sightings.cameras_told) of_told.cameras.push_back(rig.find(camera));
  const std::vector<std::string> warnings = check_picture_sizes(sightings.frames, of_told);
  return {warnings.begin(), warnings.end()};
}

bool has_tags(const Sightings& sightings) {
  return std::ranges::any_of(sightings.frames, [](const auto& one) { return !one.detections.empty(); });
}

/// By what was read before Ctrl-C, if it came so early; if it comes now, without a result.
/// told: what was said with file and line already.
CalibrationResult solve(CalibrateOptions& a, const Sightings& sightings, const CameraRig& rig,
                        const TagSizes& sizes, const std::set<std::string>& told) {
  if (!sightings.counts.is_interrupted) a.calibration.should_stop = a.refinement.should_stop = is_interrupted;
  try {
    const LogSink log = [&, to_console = a.console.log()](LogLevel level, std::string_view message) {
      if (!told.contains(std::string(message))) to_console(level, message);
    };
    return calibrate_map(sightings.frames, rig, sizes, a.calibration, log);
  } catch (const Stopped&) {
    throw no_result("calibrate", "interrupted while the map was solved: no map was written");
  } catch (const ConstraintError&) {
    throw;
  } catch (const Error& error) {
    if (!has_tags(sightings))
      throw Error(error.kind(), error.where(),
                  fmt::format("{} (apriltrack doctor looks for tags of other families)", error.cause()));
    throw with_options(error);
  }
}

/// What was found, but for what was said already.
std::vector<std::string> warnings_of(const std::vector<CalibrationFinding>& found,
                                     const std::set<std::string>& told) {
  std::vector<std::string> warnings;
  for (const CalibrationFinding& finding : found)
    if (!told.contains(finding.message)) warnings.push_back(message_with_options(finding));
  return warnings;
}

/// On the tags' pictures, where there are any; the map of `result` is then the refined one.
std::optional<RefinementResult> refine(CalibrateOptions& a, const Sightings& sightings,
                                       CalibrationResult& result) {
  if (a.no_refine || !a.detections.empty()) return std::nullopt;
  a.refinement.num_threads = a.num_threads;
  RefinementResult refinement =
      refine_map(result, sightings.frames, result.rig, a.refinement, a.console.log());
  result.findings = refinement.findings;
  result.map = refinement.map;
  result.gauge = refinement.gauge;
  result.constraint_audits = refinement.constraint_audits;
  return refinement;
}

/// Of pictures without a tag that is all there is to say.
void tell_of_odd_pictures(const CalibrateOptions& a, const Sightings& sightings) {
  if (!has_tags(sightings) && !sightings.odd_pictures.empty())
    throw no_result("calibrate", sightings.odd_pictures.front());
  for (const std::string& odd : sightings.odd_pictures) a.console.warning(odd);
  if (!has_tags(sightings) && !sightings.left_out.is_empty()) a.console.warning(sightings.left_out.message());
}

void make_map(CLI::App& command, CalibrateOptions& a) {
  if (!a.constraints.empty()) a.calibration.constraints = read_map_constraints(a.constraints);
  const CameraSource source = camera_of(a);
  const std::filesystem::path& camera = source.path;
  tell_of_own_camera(source, a.console);
  constexpr std::size_t kSeveral = 3;
  if (const auto told = told_of_replaced_pattern(a.inputs, kSeveral))
    a.console.warning(fmt::format("each of the {} INPUTs is taken for a recording of one picture; {}",
                                  a.inputs.size(), *told));
  auto [rig, to_estimate] = read_rig(source, topic_without_camera(a.frames.topics), a.console);
  const TagSizes sizes = tag_sizes(a);
  const std::vector<Recording> recordings =
      with_topics(parse_recordings(a.inputs, rig, a.camera_name), a.frames.topics, &rig, camera, a.console);
  warn_of_shutters(rig, a.camera_name, recordings, a.console);
  ResponseFindings responses = estimate_responses(a, camera, to_estimate, recordings, sizes, rig);
  Sightings sightings = gather(a, rig, recordings);
  if (a.detections.empty() && !sightings.counts.is_interrupted &&
      check_responses(a, camera, recordings, sizes, sightings, rig, responses))
    sightings = gather(a, rig, recordings);
  if (sightings.counts.is_interrupted && sightings.counts.readable == 0)
    throw no_result("calibrate", kInterruptedAtOnce);
  for (const std::string& warning : sightings.warnings) a.console.warning(warning);
  if (sightings.counts.are_all_blank() && !has_tags(sightings))
    throw no_result("calibrate", told_of_blank_images(sightings.counts.readable));
  tell_of_odd_pictures(a, sightings);

  if (!a.detections.empty()) {
    const CornerClaims claims = corner_claims_of_calibrate(sightings.frames, a.calibration.corner_bias_px);
    if (const std::string told = in_words(claims, "the map"); !told.empty()) a.console.info(told);
  }
  warn_of_unseen_sizes(a, sightings);
  complete_resolutions(a, camera, recordings, rig);  // not before: images are held against the file's own
  a.calibration.num_threads = a.num_threads;
  a.calibration.cross_validate = a.calibration.cross_validate || !a.report.empty();
  if (!a.joint_covariance.empty())
    a.calibration.max_tags_with_joint_covariance = a.calibration.max_tags_with_covariance;
  a.calibration.edge_offset_sigma_px =
      a.edge_offset_sigma_px.value_or(a.detections.empty() ? 0.0 : kForeignEdgeOffset_px);
  if (!a.held_tag.empty()) a.calibration.held_tag = parse_held_tag(a, sightings);
  const std::set<std::string> told = told_already(sightings, rig);
  CalibrationResult result = solve(a, sightings, rig, sizes, told);
  const std::optional<RefinementResult> refinement = refine(a, sightings, result);
  for (const std::string& warning : warnings_of(result.findings, told)) a.console.warning(warning);
  if (refinement && refinement->is_stopped)
    a.console.warning("interrupted: the map is as the corners have it, not refined on pictures");
  else if (refinement && !refinement->is_accepted)
    a.console.warning("not refined on the tags' pictures: " + refinement->reason);
  const CalibrationFindings findings = find(result, refinement, sightings.frames);
  const CalibrationFiles files = write_calibration(a, camera, sightings, sizes, responses, refinement,
                                                   findings, command_line_of(command), result);
  tell_calibration(a, sightings, responses, result, refinement, findings, files);
}

/// Beside the report, which may be of an earlier run that had a map. That the page cannot be written does not
/// hide the error.
void leave_page(CLI::App& command, const CalibrateOptions& a, const Error& error) {
  if (error.kind() != ErrorKind::kNoResult || a.report.empty() || error.cause().starts_with("interrupted"))
    return;
  const std::filesystem::path page = page_without_map(a.report);
  try {
    write_failure_report(page, command_line_of(command), a, error.what());
    a.console.info(fmt::format("why there is no map, on a page: {}", page.string()));
  } catch (const Error& of_page) {
    a.console.warning(of_page.what());
  }
}

void run(CLI::App& command, CalibrateOptions& a) {
  check(command, a);
  try {
    make_map(command, a);
  } catch (const ConstraintError& error) {
    leave_page(command, a, error);
    a.console.info(constraint_table(error.audits()).substr(1));  // it begins a line
    throw DetailedError(error, {{"constraints", told_constraints(error.audits())}});
  } catch (const Error& error) {
    leave_page(command, a, error);
    throw;
  }
}

}  // namespace

void add_calibrate_command(CLI::App& app) {
  CLI::App& command = add_command(app, "calibrate", kCalibrateHelp);
  const auto options = std::make_shared<CalibrateOptions>();
  add_calibrate_options(command, *options);
  command.callback([&command, options] { run(command, *options); });
}

}  // namespace apriltrack::app
