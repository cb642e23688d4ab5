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
#include "apriltrack/base/log.h"
#include "apriltrack/base/parallel.h"
#include "apriltrack/calib/calibration_options.h"
#include "apriltrack/calib/calibration_result.h"
#include "apriltrack/calib/map_constraints.h"
#include "apriltrack/calib/map_evidence.h"
#include "apriltrack/calib/stop.h"
#include "apriltrack/camera/camera.h"
#include "apriltrack/detect/detection.h"
#include "assess/halves.h"
#include "assess/part_evidence.h"
#include "cameras/time_errors.h"
#include "constraints/camera_gravity.h"
#include "constraints/constraint_tags.h"
#include "facade/part_solver.h"
#include "facade/result_of_solution.h"
#include "initialise/starting_cameras.h"
#include "messages/calibration_messages.h"
#include "messages/camera_messages.h"
#include "observations/claimed_noise.h"
#include "observations/repeated_frames.h"
#include "observations/resting_frames.h"

namespace apriltrack {
namespace {

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
    throw invalid_input("sizes",
                        fmt::format("no size is given for {}; give one for all tags, and one of its own to "
                                    "each that differs",
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
  report_unusual_sizes(observations, connectivity.parts, findings);

  std::vector<std::size_t> connected;
  for (const Part& part : connectivity.parts)
    connected.insert(connected.end(), part.views.begin(), part.views.end());
  candidates = solve_views(observations, connected, parallel);
  std::vector<bool> has_no_pose(views.size(), false);
  for (const std::size_t v : connected) has_no_pose[v] = candidates[v].candidates.empty();
  std::erase_if(views, [&](std::size_t v) { return has_no_pose[v]; });
  connectivity = find_parts(observations, views, options.min_views);
  leave_out(CalibrationFinding::Kind::kNeverWithOthers, observations, connectivity.lone_tags,
            "never seen together with another tag", findings);
  leave_out(
      CalibrationFinding::Kind::kRarelyWithOthers, observations, connectivity.rare_tags,
      fmt::format("seen in fewer than {} frames together with other tags, those of one place counted once "
                  "(min_views)",
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
      "(min_views); where those with fewer are taken away, none is left: film on the move, or take more "
      "pictures of the same tags, from several sides",
      joint == 1 ? "only 1 frame shows" : fmt::format("{} frames show", joint), min_views);
}

/// What was found before may be why.
void require_connection(const Observations& observations, const std::vector<Part>& parts,
                        const CalibrationOptions& options, const Findings& findings) {
  if (!parts.empty()) return;
  throw no_result("calibrate",
                  fmt::format("no two tags connect (seen: {}): {}{}{}", list_tags(observations.tags),
                              way_to_connect(observations, options.min_views), findings.empty() ? "" : ". ",
                              fmt::join(messages_of(findings), ". ")));
}

/// The part with the held tag first, and the tag to hold in each.
void choose_gauge(const Observations& observations, const CalibrationOptions& options,
                  const Findings& findings, std::vector<Part>& parts, std::vector<int>& held_tags) {
  if (options.held_tag) {
    const bool was_seen =
        std::binary_search(observations.tags.begin(), observations.tags.end(), *options.held_tag);
    if (!was_seen && std::ranges::binary_search(tags_left_out(findings), *options.held_tag))
      throw no_result(
          "calibrate",
          fmt::format("the held tag {} is seen at two places at once, so it is not one tag and "
                      "was left out: cover its copies, or hold one of these: {}",
                      to_string(*options.held_tag), list_tags(keys_of(observations, parts.front().tags))));
    const auto seen = std::lower_bound(observations.tags.begin(), observations.tags.end(), *options.held_tag);
    if (seen == observations.tags.end() || *seen != *options.held_tag)
      throw invalid_input("held_tag",
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
  report_repeated_frames(drop_repeated_frames(observations, kept), findings);
  return merge_frames_at_rest(observations, options, kept, findings, log);
}

/// Maps of their own, in the order of `parts` after the first; where there is none, the main map stands
/// without it. By the cameras of the main part.
void add_other_parts(Observations observations, const std::vector<Part>& parts,
                     const std::vector<int>& held_tags, const PartSolution& main,
                     const CalibrationOptions& options, const ParallelFor& parallel,
                     CalibrationResult& result, Findings& findings) {
  observations.cameras = main.state.cameras;
  for (std::size_t i = 1; i < parts.size(); ++i) {
    try {
      const std::vector<ViewCandidates> candidates = solve_views(observations, parts[i].views, parallel);
      const PartSolution other =
          solve_part(observations, {observations.cameras, candidates, &main.cameras, main.time_errors},
                     parts[i], held_tags[i], options, {}, parallel);
      MapEvidence evidence = part_evidence(observations, other, options);
      report_quality(observations, other, options, findings);
      result.time_errors = with_known(std::move(result.time_errors), other.time_errors);
      const std::size_t number = result.other_parts.size() + 2;  // the main map is the first
      result.other_parts.push_back(
          to_map(observations, other, fmt::format("{}_part_{}", options.map_frame, number)));
      result.held_tags_of_other_parts.push_back(key_of(observations, other.held_tag));
      result.evidence_of_other_parts.push_back(std::move(evidence));
    } catch (const Error& error) {
      leave_out(CalibrationFinding::Kind::kUnsolvedComponent, observations, parts[i].tags, error.what(),
                findings);
    }
  }
}

/// Lenses by which tags do not look square.
void report_lenses(const Observations& observations, const std::vector<LensDoubt>& doubts,
                   const CalibrationOptions& options, Findings& findings, const LogSink& log) {
  for (const LensDoubt& doubt : doubts) {
    if (doubt.why == LensDoubt::Why::kReplaced)
      log(LogLevel::kInfo, message_of(observations, doubt) + ": starting from one by which they do");
    else
      findings.push_back(reported(observations, doubt, options));
  }
}

CalibrationResult calibrated(std::span<const FrameDetections> frames, const CameraRig& rig,
                             const TagSizes& sizes, const CalibrationOptions& options, Findings& findings,
                             const LogSink& log) {
  const ParallelFor parallel = stoppable(parallel_for(options.num_threads), options.should_stop);
  report_picture_sizes(frames, rig, findings);
  UnusedDetections unused;
  Observations observations = collect_observations(frames, rig, sizes, options, unused);
  report_unused(unused, findings);
  CalibrationResult result;
  result.frames_at_rest =
      count_repetitions_once(observations, options, times_with_gravity(options), findings, log);
  const std::vector<MapConstraint> constraints =
      with_families(options.constraints, observations.tags, tags_left_out(findings));
  require_camera_frames(constraints, observations);
  std::vector<LensDoubt> lens_doubts;
  std::vector<RigCamera> start = starting_cameras(observations, options, parallel, lens_doubts);
  report_lenses(observations, lens_doubts, options, findings, log);
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
  const PartSolution main = solve_part(observations, {start, candidates}, parts.front(), held_tags.front(),
                                       options, constraints, parallel);
  take_cameras(observations, rig, main, options, result, findings);
  report_quality(observations, main, options, findings);
  take_map(observations, main, options, result, findings);
  if (options.cross_validate) result.cross_validation = cross_validate(observations, main, options);
  if (parts.size() > 1)
    add_other_parts(observations, parts, held_tags, main, options, parallel, result, findings);
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
    CalibrationOptions claimed = options;
    if (const auto kept = kept_errors(frames)) claimed.corner_bias_px = kept->corners_px;
    CalibrationResult result = calibrated(frames, rig, sizes, claimed, findings, log);
    result.warnings = messages_of(findings);
    result.left_out = tags_left_out(findings);
    result.findings = std::move(findings);
    result.solve_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    return result;
  } catch (const Error& error) {  // what was found before may be why
    for (const std::string& warning : messages_of(findings)) {
      if (std::string_view(error.what()).find(warning) == std::string_view::npos)
        log(LogLevel::kWarning, warning);
    }
    throw;
  }
}

}  // namespace apriltrack
