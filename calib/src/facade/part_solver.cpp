#include "facade/part_solver.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>
#include <utility>

#include "apriltrack/base/error.h"
#include "apriltrack/base/parallel.h"
#include "apriltrack/calib/calibration_options.h"
#include "apriltrack/calib/map_constraints.h"
#include "apriltrack/calib/systematic_errors.h"
#include "cameras/camera_refinement.h"
#include "cameras/time_errors.h"
#include "constraints/camera_gravity.h"
#include "faults/lost_links.h"
#include "faults/split_links.h"
#include "hypotheses/faulty_tags.h"
#include "hypotheses/improved_part.h"
#include "hypotheses/part_failure.h"
#include "hypotheses/print_aspect.h"
#include "hypotheses/print_batches.h"
#include "hypotheses/undecided_tags.h"
#include "initialise/part_adjustment.h"
#include "initialise/rig_check.h"
#include "messages/calibration_messages.h"
#include "messages/failure_messages.h"
#include "solution/errors_of_part.h"
#include "solve/bundle_adjustment.h"
#include "uncertainty/joint_tag_covariance.h"
#include "uncertainty/linear_part.h"

namespace apriltrack {
namespace {

constexpr double kNonsense_px = 5.0;

void measure_residuals(const Observations& observations, PartSolution& solution) {
  std::vector<double> sums(observations.tags.size(), 0.0);
  std::vector<int> counts(observations.tags.size(), 0);
  double total = 0.0;
  for (const std::size_t v : solution.part.views) {
    const TagView& view = observations.views[v];
    bool is_valid = false;
    Vector8d residual_px;
    whitened_residual(observations, view, solution.state, is_valid, &residual_px);
    sums[static_cast<std::size_t>(view.tag)] += residual_px.squaredNorm();
    counts[static_cast<std::size_t>(view.tag)] += 8;
    total += residual_px.squaredNorm();
  }
  for (const int tag : solution.part.tags) {
    const auto t = static_cast<std::size_t>(tag);
    solution.residual_rms_px.push_back(std::sqrt(sums[t] / std::max(counts[t], 1)));
  }
  solution.total_rms_px = std::sqrt(total / (8.0 * static_cast<double>(solution.part.views.size())));
}

std::set<int> cameras_in(const std::vector<LinearView>& views) {
  std::set<int> cameras;
  for (const LinearView& view : views) cameras.insert(view.camera);
  return cameras;
}

/// That are not as stated. A tag that is known to be bent has a size of its own.
void find_prints(const Observations& observations, const LinearPart& linear, PartSolution& solution) {
  solution.print_aspect = find_print_aspect(solution.cameras, cameras_in(linear.views));
  std::vector<int> tags = solution.part.tags;
  std::erase_if(tags, [&](int tag) {
    return std::ranges::find(solution.findings, tag, &TagFinding::tag) != solution.findings.end();
  });
  solution.print_batches = find_print_batches(observations, solution.part.views, solution.state, tags,
                                              *linear.poses, solution.scale);
  if (!solution.print_batches)
    solution.print_batches = print_batches_by(solution.findings, observations, tags);
}

/// joint: of the adjusted map.
void keep_to_constraints(const Observations& observations, const CalibrationOptions& options,
                         const CovarianceOperator& joint, PartSolution& solution) {
  ImageMap map{observations.tags, solution.part.tags, solution.held_tag, solution.state.T_map_tag, {}};
  const Pose T_held_map = map.T_held_tag[static_cast<std::size_t>(solution.held_tag)].inverse();
  for (Pose& pose : map.T_held_tag) pose = T_held_map * pose;
  for (const TagCovariance& tag : solution.covariances) map.covariances.push_back(tag.by_noise + tag.by_bias);
  map.doubts = doubts_of_map(observations, solution);
  solution.constrained = constrain_map(solution.constraints, map, joint);
  keep_to(solution.constrained->change, solution.joint);
  solution.state.T_map_tag = solution.constrained->T_map_tag;
  for (Pose& pose : solution.state.T_map_rig) pose = solution.constrained->T_map_held * T_held_map * pose;
  adjust(observations, solution.part.views, {}, adjustment_options(options),
         solution.state);  // frames follow
}

void measure_covariances(const Observations& observations, const CalibrationOptions& options,
                         const std::vector<MapConstraint>& constraints, PartSolution& solution) {
  if (solution.part.tags.size() > static_cast<std::size_t>(options.max_tags_with_covariance)) return;
  const LinearPart linear(observations, options, solution.state, solution.part, solution.held_tag);
  if (!linear.poses)
    throw no_result("calibrate",
                    "the views leave the pose of a tag undetermined; film each tag from more sides, together "
                    "with others");
  solution.scale = linear.scale;
  find_prints(observations, linear, solution);
  solution.time_errors =
      with_known(solution.known_time_errors,
                 by_the_larger(find_time_errors(observations, linear, solution.state), solution.time_errors));
  const auto shared = errors_of_part(observations, solution, linear.views, *linear.poses);
  solution.covariances = tag_covariances(*linear.poses, solution.part.tags, shared);
  scale_by(solution.scale, solution.covariances);
  if (solution.part.tags.size() <= static_cast<std::size_t>(options.max_tags_with_joint_covariance)) {
    std::vector<TagKey> keys;
    for (const int tag : solution.part.tags) keys.push_back(observations.tags[static_cast<std::size_t>(tag)]);
    solution.joint =
        joint_tag_covariance(*linear.poses, solution.part.tags, std::move(keys), solution.scale, shared);
  }
  if (constraints.empty()) return;
  solution.constraints = with_gravity_of_tags(constraints, observations, solution.part.views, linear.views,
                                              solution.state, solution.scale);
  keep_to_constraints(observations, options, CovarianceOperator(*linear.poses, solution.scale, shared),
                      solution);
}

/// That are estimated where the views ask for it.
CameraParameters parameters_to_ask(const PartTask& task, const Part& part) {
  if (task.options.intrinsics == Intrinsics::kKeep) return {};
  return intrinsic_parameters(cameras_of(task.observations, part), task.observations.cameras);
}

/// cameras: parameters that may be estimated later.
AdjustedPart adjusted(const PartTask& task, const Part& part, int held_tag, const CameraParameters& cameras,
                      const ParallelFor& parallel) {
  require_rig_that_fits(task, part);
  AdjustedPart solved = adjust_part_or_most_of_it(task, part, held_tag, parallel).value_or_throw();
  leave_out_faulty_tags(task, part, cameras, solved, parallel);
  if (const auto failure = leave_out_undecided(task, part, solved, parallel)) throw failure->to_error();
  return solved;
}

/// start: cameras that may have other lenses than the task's. What fails by these may fail for them.
AdjustedPart adjusted_from(const std::vector<RigCamera>& start, const PartTask& task, const Part& part,
                           int held_tag, const CameraParameters& cameras, const ParallelFor& parallel) {
  if (!have_other_lenses(start, task.observations.cameras))
    return adjusted(task, part, held_tag, cameras, parallel);
  Observations by_start = task.observations;
  by_start.cameras = start;
  try {
    return adjusted({by_start, task.candidates, task.options}, part, held_tag, cameras, parallel);
  } catch (const Error& error) {
    throw no_result(
        error.where(),
        fmt::format("{}. This is by another lens than the camera file's, by which the tags do not look "
                    "square: is that file of this camera, zoom and resolution?",
                    cause_of(task.observations, error)));
  }
}

/// Before lenses, or tags that are left out, take them up.
std::vector<TimeError> time_errors_of(const PartTask& task, const AdjustedPart& solved) {
  if (solved.part.tags.size() > static_cast<std::size_t>(task.options.max_tags_with_covariance)) return {};
  const LinearPart linear(task, solved.state, solved.part, solved.held_tag);
  if (!linear.poses) return {};
  return find_time_errors(task.observations, linear, solved.state);
}

void take_improved(ImprovedPart improved, PartSolution& solution) {
  AdjustedPart& solved = improved.solved;
  solution.cameras = std::move(improved.cameras);
  solution.findings = std::move(solved.findings);
  solution.contradicted = std::move(improved.contradicted);
  solution.held_tag = solved.held_tag;
  std::ranges::copy_if(solved.undecided, std::back_inserter(solution.undecided), [&](int tag) {
    return std::ranges::find(solution.findings, tag, &TagFinding::tag) == solution.findings.end();
  });
  solution.part = std::move(solved.part);
  solution.state = std::move(solved.state);
}

/// Of the tags that are mapped, before outliers were removed.
void count_offered_views(const Observations& observations, const Part& part, PartSolution& solution) {
  const Part offered = narrowed_to(observations, part, solution.part.tags);
  solution.views_offered = offered.views.size();
  solution.views_offered_by_tag.assign(observations.tags.size(), 0);
  for (const auto& [tag, views] : count_views(observations, offered))
    solution.views_offered_by_tag[static_cast<std::size_t>(tag)] = views;
  std::vector<std::size_t> rejected_at_rest;
  std::ranges::copy_if(offered.views, std::back_inserter(rejected_at_rest), [&](std::size_t v) {
    return observations.views[v].place >= 0 && !std::ranges::binary_search(solution.part.views, v);
  });
  solution.rejected_stands = find_rejected_stands(observations, solution.part, rejected_at_rest);
}

/// Views that disagree with the map, by which it may be folded.
void find_disagreeing_views(const PartTask& task, const Part& part, PartSolution& solution) {
  const Part offered = narrowed_to(task.observations, part, solution.part.tags);
  solution.lost_links = find_lost_links(task.observations, offered, solution.part);
  solution.split_links = find_split_links(task, offered, solution.part, solution.state);
}

/// Those of the part that are not mapped, and were left out for no reason of their own.
std::vector<int> lost_tags(const Part& part, const PartSolution& solution) {
  std::set<int> explained(solution.undecided.begin(), solution.undecided.end());
  explained.insert(solution.contradicted.begin(), solution.contradicted.end());
  for (const TagFinding& finding : solution.findings)
    if (finding.is_left_out) explained.insert(finding.tag);
  std::vector<int> lost;
  std::ranges::set_difference(part.tags, solution.part.tags, std::back_inserter(lost));
  std::erase_if(lost, [&](int tag) { return explained.contains(tag); });
  return lost;
}

void require_sense(const PartSolution& solution) {
  if (solution.total_rms_px < kNonsense_px) return;
  throw no_result("calibrate",
                  fmt::format("the adjusted map leaves errors of {:.1f} px: {}; corners from elsewhere must "
                              "come in the order bottom-left, bottom-right, top-right, top-left",
                              solution.total_rms_px, kWhatToCheck));
}

PartSolution solved_part(Observations& observations, const CamerasOfPart& cameras, const Part& part,
                         int held_tag, const CalibrationOptions& options,
                         const std::vector<MapConstraint>& constraints, const ParallelFor& parallel) {
  const PartTask task{observations, cameras.candidates, options};  // sees the edges that the map gives them
  const CameraParameters open = cameras.known ? CameraParameters{} : parameters_to_ask(task, part);
  AdjustedPart first = adjusted_from(cameras.start, task, part, held_tag, open, parallel);
  PartSolution solution;
  solution.time_errors = time_errors_of(task, first);
  ImprovedPart improved = improve_part(task, part, std::move(first), cameras.known, observations, parallel);
  solution.are_cameras_given = cameras.known != nullptr;
  solution.known_time_errors = cameras.time_errors;
  take_improved(std::move(improved), solution);
  const std::vector<ViewCandidates>& by_cameras = solution.cameras.candidates;
  const PartTask by_better{observations, by_cameras.empty() ? cameras.candidates : by_cameras, options};

  count_offered_views(observations, part, solution);
  find_disagreeing_views(by_better, part, solution);
  measure_covariances(observations, options, constraints, solution);
  measure_residuals(observations, solution);
  solution.lost_tags = lost_tags(part, solution);
  require_sense(solution);
  return solution;
}

}  // namespace

PartSolution solve_part(Observations& observations, const CamerasOfPart& cameras, const Part& part,
                        int held_tag, const CalibrationOptions& options,
                        const std::vector<MapConstraint>& constraints, const ParallelFor& parallel) {
  try {
    return solved_part(observations, cameras, part, held_tag, options, constraints, parallel);
  } catch (const HeldTagAtFault& error) {
    throw no_result(error.where(), cause_of(observations, error));
  } catch (const NothingLeft& error) {
    throw no_result(error.where(), cause_of(observations, error));
  }
}

}  // namespace apriltrack
