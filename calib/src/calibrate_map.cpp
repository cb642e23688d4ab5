#include "apriltrack/calib/calibrate_map.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "apriltrack/base/error.h"
#include "apriltrack/base/parallel.h"
#include "calibration_words.h"
#include "camera_gravity.h"
#include "constraint_tags.h"
#include "halves.h"
#include "part_evidence.h"
#include "part_solver.h"
#include "repeated_frames.h"
#include "resting_frames.h"
#include "starting_cameras.h"
#include "tag_flags.h"

namespace apriltrack {
namespace {

constexpr double kManyRejected = 0.1;

void require_sizes(const Observations& observations, const std::vector<Part>& parts) {
  std::vector<TagKey> missing;
  for (const Part& part : parts) {
    for (const int tag : part.tags) {
      if (!(observations.sizes_m[static_cast<std::size_t>(tag)] > 0.0))
        missing.push_back(key_of(observations, tag));
    }
  }
  std::sort(missing.begin(), missing.end());
  if (!missing.empty())
    throw invalid_input("calibrate",
                        fmt::format("no size is given for {}; use --tag-size METRES for all tags, or name "
                                    "them in the file of --tag-sizes",
                                    list_tags(missing)));
}

/// Parts whose views all have a pose to start from. Sizes are asked for only where a tag can be mapped at
/// all.
std::vector<Part> solvable_parts(const Observations& observations, const CalibrationOptions& options,
                                 const ParallelFor& parallel, std::vector<ViewCandidates>& candidates,
                                 Findings& findings) {
  std::vector<std::size_t> views(observations.views.size());
  std::iota(views.begin(), views.end(), std::size_t{0});
  Connectivity connectivity = find_parts(observations, views, options.min_views);
  require_sizes(observations, connectivity.parts);

  std::vector<std::size_t> connected;
  for (const Part& part : connectivity.parts)
    connected.insert(connected.end(), part.views.begin(), part.views.end());
  candidates = solve_views(observations, connected, parallel);
  std::vector<bool> has_no_pose(views.size(), false);
  for (const std::size_t v : connected) has_no_pose[v] = candidates[v].candidates.empty();
  std::erase_if(views, [&](std::size_t v) { return has_no_pose[v]; });
  connectivity = find_parts(observations, views, options.min_views);
  leave_out(observations, connectivity.lone_tags, "never seen together with another tag", findings);
  leave_out(
      observations, connectivity.rare_tags,
      fmt::format("seen in fewer than {} frames together with other tags, those of one place counted once "
                  "(--min-views)",
                  options.min_views),
      findings);
  return connectivity.parts;
}

/// Moments that show two tags or more.
std::size_t num_joint_moments(const Observations& observations) {
  std::map<int, std::set<int>> tags_of_frame;
  for (const TagView& view : observations.views) tags_of_frame[view.frame].insert(view.tag);
  return static_cast<std::size_t>(
      std::ranges::count_if(tags_of_frame, [](const auto& frame) { return frame.second.size() > 1; }));
}

/// Where no two tags connect.
std::string way_to_connect(const Observations& observations, int min_views) {
  if (observations.tags.size() < 2) return "a map needs at least two tags: bring more of them into view";
  const std::size_t joint = num_joint_moments(observations);
  if (joint == 0)
    return "move so that every tag shares some frames with another, in a chain that reaches all of them";
  return fmt::format(
      "{} two tags or more together. A tag is mapped from {} such frames or more, from different places "
      "(--min-views); where those with fewer are taken away, none is left: film on the move, or take more "
      "pictures of the same tags, from several sides",
      joint == 1 ? "only 1 frame shows" : fmt::format("{} frames show", joint), min_views);
}

/// What was found before may be why.
void require_connection(const Observations& observations, const std::vector<Part>& parts,
                        const CalibrationOptions& options, const Findings& findings) {
  if (!parts.empty()) return;
  throw no_result("calibrate",
                  fmt::format("no two tags connect (seen: {}): {}{}{}", list_tags(observations.tags),
                              way_to_connect(observations, options.min_views),
                              findings.warnings.empty() ? "" : ". ", fmt::join(findings.warnings, ". ")));
}

/// The part with the held tag first, and the tag to hold in each.
void choose_gauge(const Observations& observations, const CalibrationOptions& options,
                  const Findings& findings, std::vector<Part>& parts, std::vector<int>& held_tags) {
  if (options.held_tag) {
    const bool was_seen =
        std::binary_search(observations.tags.begin(), observations.tags.end(), *options.held_tag);
    if (!was_seen && std::count(findings.left_out.begin(), findings.left_out.end(), *options.held_tag) > 0)
      throw no_result(
          "calibrate",
          fmt::format("the held tag {} is seen at two places at once, so it is not one tag and "
                      "was left out: cover its copies, or hold one of these: {}",
                      to_string(*options.held_tag), list_tags(keys_of(observations, parts.front().tags))));
    const auto seen = std::lower_bound(observations.tags.begin(), observations.tags.end(), *options.held_tag);
    if (seen == observations.tags.end() || *seen != *options.held_tag)
      throw invalid_input("--held-tag",
                          fmt::format("{} was never seen; seen were: {}", to_string(*options.held_tag),
                                      list_tags(observations.tags)));
    const int held = static_cast<int>(seen - observations.tags.begin());
    const auto part = std::find_if(parts.begin(), parts.end(), [&](const Part& p) {
      return std::binary_search(p.tags.begin(), p.tags.end(), held);
    });
    if (part == parts.end())
      throw no_result(
          "calibrate",
          fmt::format("the held tag {} was seen, but too seldom together with another tag; "
                      "hold one of these: {}",
                      to_string(*options.held_tag), list_tags(keys_of(observations, parts.front().tags))));
    std::rotate(parts.begin(), part, part + 1);
    held_tags.push_back(held);
  }
  while (held_tags.size() < parts.size()) held_tags.push_back(parts[held_tags.size()].tags.front());
}

TagMap to_map(const Observations& observations, const PartSolution& solution, const std::string& frame) {
  TagMap map;
  map.frame = frame;
  map.default_family = key_of(observations, solution.part.tags.front()).family;
  std::vector<int> views(observations.tags.size(), 0);
  for (const std::size_t v : solution.part.views)
    ++views[static_cast<std::size_t>(observations.views[v].tag)];
  for (std::size_t i = 0; i < solution.part.tags.size(); ++i) {
    const auto t = static_cast<std::size_t>(solution.part.tags[i]);
    MapTag tag;
    tag.key = observations.tags[t];
    tag.size_m = observations.sizes_m[t];
    tag.T_map_tag = solution.state.T_map_tag[t];
    std::optional<TagCovariance> covariance;
    if (!solution.covariances.empty()) covariance = solution.covariances[i];
    if (covariance) tag.covariance = covariance->by_noise + covariance->by_bias;
    std::optional<Matrix6d> constrained;
    if (solution.constrained && !solution.constrained->change.lost_root.isZero(0.0))
      constrained = solution.constrained->covariances[i];
    if (solution.constrained) tag.covariance = solution.constrained->covariances[i];
    tag.statistics = TagStatistics{views[t], solution.residual_rms_px[i], {}};
    const std::optional<Matrix6d> by_noise = covariance ? std::optional(covariance->by_noise) : std::nullopt;
    flag_weak(is_weak(tag, views[t], by_noise, constrained), *tag.statistics);
    if (1.0 - static_cast<double>(views[t]) / solution.views_offered_by_tag[t] > kManyRejected)
      tag.statistics->flags.emplace_back("outliers");
    if (std::ranges::find(solution.findings, static_cast<int>(t), &TagFinding::tag) !=
        solution.findings.end())  // others with a fault are not in the map
      tag.statistics->flags.emplace_back("bent");
    map.tags.push_back(std::move(tag));
  }
  return map;
}

/// Into observations.frames, each once.
std::vector<int> frames_of(const Observations& observations, const std::vector<std::size_t>& views) {
  std::vector<int> frames;
  for (const std::size_t v : views) frames.push_back(observations.views[v].frame);
  frames.erase(std::unique(frames.begin(), frames.end()), frames.end());
  return frames;
}

std::vector<RigPose> rig_poses(const Observations& observations, const PartSolution& solution) {
  std::vector<RigPose> poses;
  for (const int frame : frames_of(observations, solution.part.views)) {
    const auto f = static_cast<std::size_t>(frame);
    poses.push_back({observations.frames[f], solution.state.T_map_rig[f]});
  }
  return poses;
}

/// The cameras as the part was solved with them, and what was corrected.
void take_cameras(const Observations& observations, const CameraRig& rig, const PartSolution& solution,
                  const CalibrationOptions& options, CalibrationResult& result, Findings& findings) {
  result.rig = rig;
  if (!solution.cameras.refined.is_accepted) return;
  bool is_offset_alone = true;
  for (const EstimatedParameter& one : solution.cameras.refined.estimates) {
    const auto camera = static_cast<std::size_t>(one.parameter.camera);
    result.corrections.push_back({rig.cameras[camera].name,
                                  name_of(one.parameter, observations.cameras[camera]),
                                  unit_of(one.parameter), one.value, one.sigma});
    is_offset_alone = is_offset_alone && one.parameter.kind == CameraParameter::Kind::kEdgeOffset;
  }
  result.corrections_covariance = solution.cameras.refined.covariance;
  std::vector<CameraParameter> parameters;
  for (const EstimatedParameter& one : solution.cameras.refined.estimates)
    parameters.push_back(one.parameter);
  result.rig = with_corrections(rig, solution.state.cameras, parameters);
  warn_of_edges(result.corrections, options, findings);
  if (is_offset_alone) return;
  findings.warnings.push_back(corrections_in_words(solution.cameras.refined, result.corrections));
}

/// Constraints weigh against the covariance of all tags.
void require_covariances(const CalibrationOptions& options, const Part& part) {
  if (options.constraints.empty() ||
      part.tags.size() <= static_cast<std::size_t>(options.max_tags_with_covariance))
    return;
  throw invalid_input(
      "constraints",
      fmt::format("need the covariance of all tags, and the map has {} of them (at most {}): leave "
                  "them away, or map fewer tags at a time",
                  part.tags.size(), options.max_tags_with_covariance));
}

/// What constraints made of the map, and what is to be said of them.
void take_constraints(const PartSolution& solution, CalibrationResult& result, Findings& findings) {
  result.gauge = to_string(result.held_tag) + " held at the origin";
  if (!solution.constrained) return;
  result.is_frame_measured = !solution.constrained->gauge.empty();
  if (result.is_frame_measured) result.gauge = solution.constrained->gauge;
  result.is_vertical_measured = solution.constrained->is_vertical_measured;
  result.constraint_audits = solution.constrained->audits;
  for (std::size_t i = 0; i < solution.constraints.size(); ++i) {
    if (result.constraint_audits[i].is_used) result.constraints.push_back(solution.constraints[i]);
  }
  result.constraint_doubts = solution.constrained->doubts;
  for (const auto* words : {&solution.constrained->warnings, &solution.constrained->doubts})
    findings.warnings.insert(findings.warnings.end(), words->begin(), words->end());
}

std::size_t num_moments(const Observations& observations) {
  std::set<int> frames;
  for (const TagView& view : observations.views) frames.insert(view.frame);
  return frames.size();
}

/// Times of the frames whose gravity is told: they stay as they are.
std::set<Timestamp> times_with_gravity(const CalibrationOptions& options) {
  std::set<Timestamp> times;
  for (const MapConstraint& constraint : options.constraints) {
    if (const auto* gravity = std::get_if<CameraGravityConstraint>(&constraint.what))
      times.insert(gravity->timestamp);
  }
  return times;
}

int merge_frames_at_rest(Observations& observations, const CalibrationOptions& options,
                         const std::set<Timestamp>& kept, Findings& findings, const LogSink& log) {
  const std::size_t before = num_moments(observations);
  const RestingFrames resting = merge_resting_frames(
      observations, options.same_place_px, {options.corner_sigma_px, options.edge_end_correlation}, kept);
  if (resting.merged == 0) return 0;
  report_resting_frames(resting, before, findings, log);
  return resting.merged;
}

/// What films that stand still, and frames at rest, repeat counts once. kept: as merge_frames_at_rest's. How
/// many frames at rest there were.
int count_repetitions_once(Observations& observations, const CalibrationOptions& options,
                           const std::set<Timestamp>& kept, Findings& findings, const LogSink& log) {
  if (const int repeated = drop_repeated_frames(observations, kept); repeated > 0)
    findings.warnings.push_back(
        fmt::format("{} exactly the corners of an earlier one, and {} not counted: a film that stands "
                    "still, or frames that were copied, say no more than one picture",
                    repeated == 1 ? "1 frame shows" : fmt::format("{} frames show", repeated),
                    repeated == 1 ? "is" : "are"));
  return merge_frames_at_rest(observations, options, kept, findings, log);
}

/// How well the part was seen, and what it was seen in.
void take_statistics(const Observations& observations, const PartSolution& solution,
                     const CalibrationOptions& options, CalibrationResult& result) {
  result.residual_rms_px = solution.total_rms_px;
  result.frames_used = static_cast<int>(frames_of(observations, solution.part.views).size());
  result.observations_used = static_cast<int>(solution.part.views.size());
  result.observations_rejected = static_cast<int>(solution.views_offered - solution.part.views.size());
  result.evidence = part_evidence(observations, solution, options);
}

/// What all parts are solved with.
struct PartsTask {
  Observations& observations;
  const std::vector<RigCamera>& start;
  const std::vector<ViewCandidates>& candidates;
  const CalibrationOptions& options;
  const ParallelFor& parallel;
  const LogSink& log;
};

/// A map of its own, named `number`; where there is none, the main map stands without it.
void add_part(const PartsTask& task, const Part& part, int held_tag, std::size_t number,
              CalibrationResult& result, Findings& findings) {
  try {
    const PartSolution other = solve_part(task.observations, task.start, part, held_tag, task.candidates,
                                          task.options, {}, task.parallel, task.log);
    report_quality(task.observations, other, task.options, findings);
    result.other_parts.push_back(
        to_map(task.observations, other, fmt::format("{}_part_{}", task.options.map_frame, number)));
    result.evidence_of_other_parts.push_back(part_evidence(task.observations, other, task.options));
  } catch (const Error& error) {
    leave_out(task.observations, part.tags, error.what(), findings);
  }
}

/// By the cameras of the main part, where these were refined: no part has a lens of its own.
struct CamerasOfParts {
  Observations observations;
  CalibrationOptions options;
};

std::optional<CamerasOfParts> refined_for_parts(const Observations& observations, const PartSolution& main,
                                                const CalibrationOptions& options) {
  if (!main.cameras.refined.is_accepted) return std::nullopt;
  CamerasOfParts refined{observations, options};
  refined.observations.cameras = main.state.cameras;
  refined.options.intrinsics = Intrinsics::kKeep;
  refined.options.refine_extrinsics = false;
  refined.options.edge_offset_sigma_px = 0.0;
  return refined;
}

CalibrationResult calibrated(std::span<const FrameDetections> frames, const CameraRig& rig,
                             const TagSizes& sizes, const CalibrationOptions& options, Findings& findings,
                             const LogSink& log) {
  const ParallelFor parallel = stoppable(parallel_for(options.num_threads), options.should_stop);
  Observations observations = collect_observations(frames, rig, sizes, options, findings);
  CalibrationResult result;
  result.frames_at_rest =
      count_repetitions_once(observations, options, times_with_gravity(options), findings, log);
  const std::vector<MapConstraint> constraints =
      with_families(options.constraints, observations.tags, findings.left_out);
  require_camera_frames(constraints, observations);
  std::vector<RigCamera> start = starting_cameras(observations, options, parallel, log, findings);
  std::vector<ViewCandidates> candidates;
  std::swap(observations.cameras, start);
  std::vector<Part> parts = solvable_parts(observations, options, parallel, candidates, findings);
  std::swap(observations.cameras, start);
  require_connection(observations, parts, options, findings);
  std::vector<int> held_tags;
  choose_gauge(observations, options, findings, parts, held_tags);
  report_other_parts(observations, parts, findings);
  require_covariances(options, parts.front());

  log(LogLevel::kInfo, fmt::format("adjusting {} tags from {} observations", parts.front().tags.size(),
                                   parts.front().views.size()));
  const PartSolution main = solve_part(observations, start, parts.front(), held_tags.front(), candidates,
                                       options, constraints, parallel, log);
  take_cameras(observations, rig, main, options, result, findings);
  report_quality(observations, main, options, findings);
  result.held_tag = key_of(observations, main.held_tag);
  result.map = to_map(observations, main, options.map_frame);
  take_constraints(main, result, findings);
  take_statistics(observations, main, options, result);
  result.rig_poses = rig_poses(observations, main);
  if (options.cross_validate) result.cross_validation = cross_validate(observations, main, options);
  auto refined = parts.size() > 1 ? refined_for_parts(observations, main, options) : std::nullopt;
  Observations& of_parts = refined ? refined->observations : observations;
  for (std::size_t i = 1; i < parts.size(); ++i) {
    if (refined) candidates = solve_views(of_parts, parts[i].views, parallel);
    add_part({of_parts, refined ? of_parts.cameras : start, candidates, refined ? refined->options : options,
              parallel, log},
             parts[i], held_tags[i], i + 1, result, findings);
  }
  return result;
}

}  // namespace

CalibrationResult calibrate_map(std::span<const FrameDetections> frames, const CameraRig& rig,
                                const TagSizes& sizes, const CalibrationOptions& options,
                                const LogSink& log) {
  options.check();
  const auto begin = std::chrono::steady_clock::now();
  Findings findings;
  try {
    CalibrationResult result = calibrated(frames, rig, sizes, options, findings, log);
    result.warnings = std::move(findings.warnings);
    result.left_out = std::move(findings.left_out);
    std::sort(result.left_out.begin(), result.left_out.end());
    result.solve_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    return result;
  } catch (const Error& error) {  // what was found before may be why
    for (const std::string& warning : findings.warnings) {
      if (std::string_view(error.what()).find(warning) == std::string_view::npos)
        log(LogLevel::kWarning, warning);
    }
    throw;
  }
}

}  // namespace apriltrack
