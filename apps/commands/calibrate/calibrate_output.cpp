#include "calibrate_output.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <ctime>
#include <utility>

#include "apriltrack/base/error.h"
#include "apriltrack/base/version.h"
#include "apriltrack/camera/response_tables.h"
#include "apriltrack/detect/detections_csv.h"
#include "apriltrack/io/numbers.h"
#include "apriltrack/io/staged_files.h"
#include "calibrate_report.h"

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
  return {
      {"tool", std::string("apriltrack ") + version()},
      {"date", fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", utc)},
      {"inputs", fmt::format("{}{}{}", fmt::join(inputs, ", "), a.frames.topics.empty() ? "" : "; topics ",
                             fmt::join(a.frames.topics, ", "))},
      {"camera", camera.string() + (a.camera_name.empty() ? "" : " " + a.camera_name)},
      {"options",
       fmt::format(
           "family {}; tag size {}; sizes file {}; constraints {}; min views {}; rate {}; skip {}; step {}; "
           "max frames {}; decimate {:g}; intrinsics {}; extrinsics {}; edge offset sigma {:g} px",
           fmt::join(a.detector.families, " "), a.tag_size_m ? format_exact(*a.tag_size_m) : "-",
           a.tag_sizes.empty() ? "-" : a.tag_sizes, a.constraints.empty() ? "-" : a.constraints,
           a.calibration.min_views,
           a.frames.source.rate_hz ? fmt::format("{:g} Hz", *a.frames.source.rate_hz) : "-",
           a.frames.source.skip, a.frames.source.step,
           a.frames.source.max_frames ? std::to_string(*a.frames.source.max_frames) : "-",
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
  outputs.make_folder(a.parts);
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

/// It is as old as the run that gave no map.
void warn_of_older_failure(const CalibrateOptions& a) {
  const fs::path page = page_without_map(a.report);
  std::error_code ignored;
  if (fs::exists(page, ignored))
    a.console.warning(fmt::format("{} is of an earlier run, which gave no map: remove it", page.string()));
}

/// Where there is one; returns where to.
std::optional<fs::path> write_camera(const CalibrateOptions& a, const CameraRig& rig, StagedFiles& outputs) {
  const std::optional<fs::path> file = refined_camera_file(a);
  if (file) {
    write_cameras(outputs, *file, rig);
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

bool is_response_news(const ResponseFindings& responses) {
  return std::ranges::any_of(responses, &ResponseFinding::is_news);
}

std::string words_of_estimated(const ResponseFindings& responses) {
  std::vector<std::string> words;
  for (const ResponseFinding& one : responses) {
    if (one.origin == ResponseOrigin::kEstimated)
      words.push_back(fmt::format("of {} estimated: {}", one.camera, one.estimate.response.name()));
  }
  return fmt::format("{}", fmt::join(words, "; "));
}

}  // namespace

CalibrationFiles write_calibration(const CalibrateOptions& a, const fs::path& camera,
                                   const Sightings& sightings, const TagSizes& sizes,
                                   const ResponseFindings& responses,
                                   const std::optional<RefinementResult>& refinement,
                                   const CalibrationFindings& findings, const std::string& command_line,
                                   CalibrationResult& result) {
  CalibrationFiles files;
  files.observations = observations_file(a);
  note_origin(a, camera, sightings.counts, result.gauge, files.observations, result.map);
  if (const std::string estimated = words_of_estimated(responses); !estimated.empty())
    result.map.provenance.emplace_back("response", estimated);
  if (refinement) result.map.provenance.emplace_back("refinement", outcome_of(*refinement));
  for (std::size_t i = 0; i < result.other_parts.size(); ++i)
    note_origin(a, camera, sightings.counts,
                to_string(result.held_tags_of_other_parts[i]) + " held at the origin", files.observations,
                result.other_parts[i]);
  const bool goes_beside =
      files.observations && !is_detections_input(a, *files.observations);  // that may hold more than was used
  // A run that fails in between must not leave an old map beside new observations, nor any part replaced.
  StagedFiles outputs;
  if (goes_beside) {
    outputs.write(*files.observations,
                  [&](const fs::path& path) { write_detections_csv(path, sightings.frames); });
  }
  if (is_lens_refined(result) || is_response_news(responses)) {
    files.camera = write_camera(a, result.rig, outputs);
  } else {
    warn_of_older_camera(a, camera);
  }
  files.parts = write_parts(a, result, outputs);
  files.has_joint_covariance = write_joint_covariance(a, result.map, *findings.joint, outputs);
  if (!a.report.empty()) {
    warn_of_older_failure(a);
    const CalibrateRun run{command_line, a,      camera,     sightings, sizes,
                           responses,    result, refinement, findings};
    outputs.write(a.report, [&](const fs::path& path) { write_calibrate_report(path, run); });
  }
  outputs.write(a.output, [&](const fs::path& path) { write_tag_map(path, result.map); });
  outputs.commit();
  return files;
}

}  // namespace apriltrack::app
