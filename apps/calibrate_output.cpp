#include "calibrate_output.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <ctime>
#include <nlohmann/json.hpp>
#include <utility>

#include "apriltrack/base/error.h"
#include "apriltrack/detect/detections_csv.h"
#include "apriltrack/io/numbers.h"
#include "apriltrack/io/staged_files.h"
#include "calibrate_report.h"
#include "calibrate_report_tables.h"
#include "constraint_table.h"

namespace apriltrack::app {
namespace {

namespace fs = std::filesystem;

std::vector<std::pair<std::string, std::string>> provenance(const CalibrateOptions& a, const fs::path& camera,
                                                            const std::string& gauge,
                                                            const std::optional<fs::path>& observations) {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  const auto& inputs = a.detections.empty() ? a.inputs : a.detections;
  return {{"tool", "apriltrack " APRILTRACK_VERSION},
          {"date", fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", utc)},
          {"inputs", fmt::format("{}", fmt::join(inputs, ", "))},
          {"camera", camera.string() + (a.camera_name.empty() ? "" : " " + a.camera_name)},
          {"options",
           fmt::format(
               "family {}; tag size {}; sizes file {}; constraints {}; min views {}; rate {}; step {}; "
               "max frames {}; decimate {:g}; intrinsics {}; extrinsics {}; edge offset sigma {:g} px",
               fmt::join(a.detector.families, " "), a.tag_size_m ? format_exact(*a.tag_size_m) : "-",
               a.tag_sizes.empty() ? "-" : a.tag_sizes, a.constraints.empty() ? "-" : a.constraints,
               a.calibration.min_views, a.source.rate_hz ? fmt::format("{:g} Hz", *a.source.rate_hz) : "-",
               a.source.step, a.source.max_frames ? std::to_string(*a.source.max_frames) : "-",
               a.detector.decimate, name_of_intrinsics(a.calibration.intrinsics),
               a.calibration.refine_extrinsics ? "refine" : "keep", a.calibration.edge_offset_sigma_px)},
          {"gauge", gauge},
          {"observations", observations ? observations->filename().string() : "not written"}};
}

void note_origin(const CalibrateOptions& a, const fs::path& camera, const FrameCounts& counts,
                 const std::string& gauge, const std::optional<fs::path>& observations, TagMap& map) {
  map.provenance = provenance(a, camera, gauge, observations);
  if (counts.is_interrupted)
    map.provenance.emplace_back("interrupted",
                                fmt::format("while reading, after {} frames", counts.readable));
}

std::string outcome_of(const RefinementResult& refinement) {
  if (!refinement.is_accepted) return "none: " + refinement.reason;
  return fmt::format("of {} tags on {} of their pictures", refinement.refined.size(), refinement.views_used);
}

fs::path part_file(const CalibrateOptions& a, std::size_t number) {
  return fs::path(a.parts) / fmt::format("part_{}.yaml", number);
}

void warn_of_older_parts(const CalibrateOptions& a, std::size_t num_parts) {
  for (std::size_t number = num_parts + 1; fs::exists(part_file(a, number)); ++number)
    a.console.warning(fmt::format("{} is of an earlier run: this one has {} parts",
                                  part_file(a, number).string(), num_parts));
}

std::vector<std::string> write_parts(const CalibrateOptions& a, const CalibrationResult& result,
                                     StagedFiles& outputs) {
  std::vector<std::string> written;
  if (a.parts.empty()) return written;
  std::error_code error;
  fs::create_directories(a.parts, error);
  if (error) throw io_error(a.parts, error.message());
  std::vector<const TagMap*> maps = {&result.map};
  for (const TagMap& part : result.other_parts) maps.push_back(&part);
  for (std::size_t i = 0; i < maps.size(); ++i) {
    written.push_back(part_file(a, i + 1).string());
    outputs.write(written.back(), [&](const fs::path& path) { write_tag_map(path, *maps[i]); });
  }
  warn_of_older_parts(a, maps.size());
  return written;
}

/// Left as it is: it may be somebody's own. But who takes it for this map's camera tracks with a wrong one.
void warn_of_older_camera(const CalibrateOptions& a, const fs::path& camera) {
  const std::optional<fs::path> file = refined_camera_file(a);
  std::error_code ignored;
  if (!file || !fs::exists(*file, ignored) || fs::equivalent(*file, camera, ignored)) return;
  a.console.warning(
      fmt::format("{} is not of this run, which refined no camera: track with {}, and remove it",
                  file->string(), camera.string()));
}

/// Where there is one; returns where to.
std::optional<fs::path> write_camera(const CalibrateOptions& a, const CameraRig& rig, StagedFiles& outputs) {
  const std::optional<fs::path> file = refined_camera_file(a);
  if (file) {
    outputs.write(*file, [&](const fs::path& path) { write_cameras(path, rig); });
  } else {
    a.console.warning(
        fmt::format("the map goes with a camera that this run refined or estimated, which is not written: {} "
                    "is no file to write it beside. Name a file as --output",
                    a.output));
  }
  return file;
}

/// What was refined from pictures has no covariance with what they do not show well enough.
void warn_of_tags_without(const CalibrateOptions& a, const TagMap& map, const JointCovariance& joint) {
  std::vector<std::string> names;
  for (const MapTag& tag : map.tags)
    if (!joint.row_of(tag.key)) names.push_back(to_string(tag.key));
  if (names.empty()) return;
  a.console.warning(
      fmt::format("--joint-covariance: {} is without {}, which the refinement from pictures left out; "
                  "--no-refine writes that of all tags, by corners",
                  a.joint_covariance, fmt::join(names, ", ")));
}

/// Whether there is one to write. It was asked for beside the map, which is as good without.
bool write_joint_covariance(const CalibrateOptions& a, const TagMap& map, const JointCovariance& joint,
                            StagedFiles& outputs) {
  if (a.joint_covariance.empty()) return false;
  if (!joint.is_empty()) {
    outputs.write(a.joint_covariance,
                  [&](const fs::path& path) { apriltrack::write_joint_covariance(path, map, joint); });
    warn_of_tags_without(a, map, joint);
    return true;
  }
  std::error_code ignored;
  a.console.warning(fmt::format(
      "--joint-covariance: the map has {} tags, and covariances are reckoned for {} at most: not written{}",
      map.tags.size(), a.calibration.max_tags_with_covariance,
      fs::exists(a.joint_covariance, ignored) ? "; " + a.joint_covariance + " is not of this run" : ""));
  return false;
}

std::vector<TagKey> keys_of(const TagMap& map) {
  std::vector<TagKey> keys;
  for (const MapTag& tag : map.tags) keys.push_back(tag.key);
  return keys;
}

nlohmann::json told(const RefinementResult& refinement) {
  nlohmann::json summary = {{"accepted", refinement.is_accepted},
                            {"held_out_before", refinement.held_out_before},
                            {"held_out_after", refinement.held_out_after}};
  if (!refinement.is_accepted) {
    summary["reason"] = refinement.reason;
    return summary;
  }
  summary["tags"] = told_keys(refinement.refined);
  summary["moments_used"] = refinement.moments_used;
  summary["views_used"] = refinement.views_used;
  for (const LensBlur& lens : refinement.lens_blurs) summary["psf_sigma_px"][lens.camera] = lens.sigma_px;
  return summary;
}

nlohmann::json told(const std::vector<CameraCorrection>& corrections) {
  nlohmann::json list = nlohmann::json::array();
  for (const CameraCorrection& one : corrections)
    list.push_back({{"camera", one.camera},
                    {"parameter", one.parameter},
                    {"unit", one.unit},
                    {"value", one.value},
                    {"sigma", one.sigma}});
  return list;
}

nlohmann::json told(const PrintBatches& batches) {
  return {{"larger", told_keys(batches.larger)},
          {"smaller", told_keys(batches.smaller)},
          {"log_ratio", batches.log_ratio},
          {"sigma", batches.sigma}};
}

nlohmann::json told(const ResponseFindings& responses) {
  nlohmann::json list = nlohmann::json::array();
  for (const ResponseFinding& one : responses)
    list.push_back({{"camera", one.camera},
                    {"exponent", one.estimate.exponent},
                    {"sigma", one.estimate.sigma},
                    {"assumed", one.assumed},
                    {"held_out_sigmas", one.estimate.held_out_sigmas},
                    {"used", one.is_used ? one.estimate.response.name() : one.assumed}});
  return list;
}

bool is_response_estimated(const ResponseFindings& responses) {
  return std::ranges::any_of(responses, &ResponseFinding::is_used);
}

std::string words_of_estimated(const ResponseFindings& responses) {
  std::vector<std::string> words;
  for (const ResponseFinding& one : responses) {
    if (one.is_used)
      words.push_back(fmt::format("of {} estimated: {}", one.camera, one.estimate.response.name()));
  }
  return fmt::format("{}", fmt::join(words, "; "));
}

/// An edge offset is the detector's; all else is the camera's.
bool is_lens_refined(const CalibrationResult& result) {
  return std::ranges::any_of(result.corrections,
                             [](const CameraCorrection& one) { return one.parameter != "edge offset"; });
}

std::string words_of(const RefinementResult& refinement) {
  return fmt::format(
      "refined on {} pictures of {} tags: those that were held out disagree with the map by {:.1f} sigmas "
      "before, {:.1f} after; lens blur {}",
      refinement.views_used, refinement.refined.size(), refinement.held_out_before, refinement.held_out_after,
      in_words(refinement.lens_blurs));
}

}  // namespace

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

CalibrationFiles write_calibration(const CalibrateOptions& a, const fs::path& camera,
                                   const Sightings& sightings, const ResponseFindings& responses,
                                   const std::optional<RefinementResult>& refinement,
                                   const CalibrationFindings& findings, const std::string& command_line,
                                   CalibrationResult& result) {
  CalibrationFiles files;
  files.observations = observations_file(a);
  note_origin(a, camera, sightings.counts, result.gauge, files.observations, result.map);
  if (is_response_estimated(responses))
    result.map.provenance.emplace_back("response", words_of_estimated(responses));
  if (refinement) result.map.provenance.emplace_back("refinement", outcome_of(*refinement));
  for (TagMap& part : result.other_parts)
    note_origin(a, camera, sightings.counts, to_string(part.tags.front().key) + " held at the origin",
                files.observations, part);
  const bool goes_beside =
      files.observations && !is_detections_input(a, *files.observations);  // that may hold more than was used
  // A run that fails in between must not leave an old map beside new observations, nor any part replaced.
  StagedFiles outputs;
  if (goes_beside) {
    outputs.write(*files.observations,
                  [&](const fs::path& path) { write_detections_csv(path, sightings.frames); });
  }
  if (is_lens_refined(result) || is_response_estimated(responses)) {
    files.camera = write_camera(a, result.rig, outputs);
  } else {
    warn_of_older_camera(a, camera);
  }
  files.parts = write_parts(a, result, outputs);
  files.has_joint_covariance = write_joint_covariance(a, result.map, *findings.joint, outputs);
  if (!a.report.empty()) {
    const CalibrateRun run{command_line, a, camera, sightings, responses, result, refinement, findings};
    outputs.write(a.report, [&](const fs::path& path) { write_calibrate_report(path, run); });
  }
  outputs.write(a.output, [&](const fs::path& path) { write_tag_map(path, result.map); });
  outputs.commit();
  return files;
}

void tell_calibration(const CalibrateOptions& a, const Sightings& sightings,
                      const ResponseFindings& responses, const CalibrationResult& result,
                      const std::optional<RefinementResult>& refinement, const CalibrationFindings& findings,
                      const CalibrationFiles& files) {
  nlohmann::json other_parts = nlohmann::json::array();
  for (const TagMap& part : result.other_parts) other_parts.push_back(told_keys(keys_of(part)));
  const bool was_interrupted = sightings.counts.is_interrupted || (refinement && refinement->is_stopped);
  nlohmann::json summary = {{"tags", told_keys(keys_of(result.map))},
                            {"held_tag", to_string(result.held_tag)},
                            {"frames", sightings.counts.readable},
                            {"unreadable", sightings.counts.unreadable},
                            {"frames_used", result.frames_used},
                            {"solve_s", result.solve_s},
                            {"frames_at_rest", result.frames_at_rest},
                            {"observations_used", result.observations_used},
                            {"observations_rejected", result.observations_rejected},
                            {"residual_rms_px", result.residual_rms_px},
                            {"left_out", told_keys(result.left_out)},
                            {"other_parts", other_parts},
                            {"part_files", files.parts},
                            {"gauge", result.gauge},
                            {"corrections", told(result.corrections)},
                            {"open_corrections", told(result.open_corrections)},
                            {"interrupted", was_interrupted},
                            {"output", a.output}};
  if (files.observations) summary["observations"] = files.observations->string();
  if (!a.constraints.empty()) summary["constraints"] = told_constraints(result.constraint_audits);
  tell_machines(findings, result, summary);
  if (!a.report.empty()) summary["report"] = a.report;
  if (files.has_joint_covariance) summary["joint_covariance"] = a.joint_covariance;
  if (!responses.empty()) summary["responses"] = told(responses);
  if (refinement) summary["refinement"] = told(*refinement);
  if (result.print_batches) summary["print_batches"] = told(*result.print_batches);
  if (result.print_aspect) summary["print_aspect"] = *result.print_aspect;
  if (files.camera) summary["camera"] = files.camera->string();
  std::string text = fmt::format(
      "{} tags from {} of {} frames ({} unreadable); {} observations, {} rejected; residual {:.3f} px (rms "
      "per axis)\n"
      "origin: {}\nmap: {}",
      result.map.tags.size(), result.frames_used, sightings.counts.readable, sightings.counts.unreadable,
      result.observations_used, result.observations_rejected, result.residual_rms_px, result.gauge, a.output);
  if (files.observations) text += "\nobservations: " + files.observations->string();
  text += constraint_table(result.constraint_audits);
  if (refinement && refinement->is_accepted) text += "\n" + words_of(*refinement);
  if (files.camera)
    text += fmt::format("\n{} camera: {}", is_lens_refined(result) ? "refined" : "estimated",
                        files.camera->string());
  for (const std::string& file : files.parts) text += "\npart: " + file;
  text += tell_people(findings, result);
  if (files.has_joint_covariance) text += "\njoint covariance: " + a.joint_covariance;
  if (!a.report.empty()) text += "\nreport: " + a.report;
  a.console.finish(summary, text);
}

}  // namespace apriltrack::app
