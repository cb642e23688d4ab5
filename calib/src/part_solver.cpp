#include "part_solver.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <set>
#include <utility>

#include "apriltrack/base/error.h"
#include "block_scatter.h"
#include "camera_gravity.h"
#include "contradicted_tags.h"
#include "corner_views.h"
#include "culprit_search.h"
#include "error_scale.h"
#include "joint_tag_covariance.h"
#include "part_adjustment.h"
#include "part_without.h"
#include "reduced_equations.h"
#include "tag_examination.h"
#include "undecided_tags.h"

namespace apriltrack {
namespace {

constexpr double kNonsense_px = 5.0;
constexpr double kOtherFocalLengths[] = {-0.07, -0.035, 0.035, 0.07};  // shares
constexpr double kMost = 0.9;                                          // of the views
constexpr double kClearlyMore = 0.03;                                  // of them
constexpr double kClearGain = 0.05;                                    // of a lens that was not asked for

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

/// Those of the cameras that were estimated with the poses. views: linearised, `poses` is made from them.
std::optional<SharedErrors> errors_of_cameras(const Observations& observations, const PartSolution& solution,
                                              const std::vector<LinearView>& views,
                                              const PoseInformation& poses) {
  if (!solution.cameras.is_accepted) return std::nullopt;
  std::vector<CameraParameter> parameters;
  for (const EstimatedParameter& one : solution.cameras.estimates) parameters.push_back(one.parameter);
  const std::vector<ParameterView> columns =
      camera_columns(observations, solution.part.views, solution.state, parameters);
  SharedParameters shared{poses.eliminate_poses(columns), {}};
  // One, in the units of the residuals, whose variance this is.
  const double noise_variance = solution.scale.noise_variance;
  shared.prior_precision = Eigen::VectorXd::Constant(shared.information.gradient.size(), noise_variance);
  shared.noise_factor =
      BlockScatter(views, poses).parameters_factor(columns, shared.information, noise_variance);
  return SharedErrors(shared);
}

std::vector<int> cameras_of(const Observations& observations, const Part& part) {
  std::set<int> cameras;
  for (const std::size_t v : part.views) cameras.insert(observations.views[v].camera);
  return {cameras.begin(), cameras.end()};
}

/// What may be mapped still.
Part without_left_out(const Observations& observations, const Part& part, const AdjustedPart& solved) {
  std::set<int> out(solved.undecided.begin(), solved.undecided.end());
  out.insert(solved.culprits.begin(), solved.culprits.end());
  Part rest{{}, views_without(observations, part, out)};
  std::ranges::set_difference(part.tags, out, std::back_inserter(rest.tags));
  return rest;
}

/// Edge offsets alone first, which are most often what is wrong with corners from elsewhere; then lenses, and
/// cameras' places.
CameraRefinement better_cameras(const PartTask& task, const Part& part, AdjustedPart& solved) {
  const CalibrationOptions& options = task.options;
  const std::vector<int> cameras = cameras_of(task.observations, solved.part);
  std::vector<CameraParameter> parameters;
  const auto add = [&](const std::vector<CameraParameter>& more) {
    parameters.insert(parameters.end(), more.begin(), more.end());
  };
  const bool has_other_focal_length = std::ranges::any_of(cameras, [&](int camera) {
    const auto c = static_cast<std::size_t>(camera);
    return solved.state.cameras[c].model.pinhole().fx != task.observations.cameras[c].model.pinhole().fx;
  });
  CameraRefinement result;
  if (options.edge_offset_sigma_px > 0.0) {
    add(edge_offset_parameters(cameras, options.edge_offset_sigma_px));
    if (!has_other_focal_length) result = refine_cameras(task, part, parameters, 0.0, solved);
  }
  if (options.intrinsics == Intrinsics::kKeep && !options.refine_extrinsics) return result;
  if (options.intrinsics != Intrinsics::kKeep) add(intrinsic_parameters(cameras, task.observations.cameras));
  if (options.refine_extrinsics) add(extrinsic_parameters(cameras));
  if (has_other_focal_length) {
    CameraRefinement forced = refine_cameras(task, part, parameters, -1.0, solved);
    if (!forced.is_accepted)
      throw no_result(
          "calibrate",
          fmt::format("the views agree with a focal length that is not the camera file's, but do not "
                      "determine it: {}",
                      kWhatToCheck));
    return forced;
  }
  const bool is_asked_for = options.intrinsics == Intrinsics::kRefine || options.refine_extrinsics;
  CameraRefinement of_all = refine_cameras(task, part, parameters, is_asked_for ? 0.0 : kClearGain, solved);
  if (of_all.is_accepted || !result.is_accepted) return of_all;
  result.reason = of_all.reason;
  return result;
}

/// A lens that agrees clearly better than the file's, which the user keeps all the same; `solved` is a copy.
std::optional<CameraRefinement> lens_not_taken(const PartTask& task, const Part& part, AdjustedPart solved) {
  if (task.options.intrinsics != Intrinsics::kKeep) return std::nullopt;
  CameraRefinement lens = refine_cameras(
      task, part, intrinsic_parameters(cameras_of(task.observations, solved.part), task.observations.cameras),
      kClearGain, solved);
  if (!lens.is_accepted) return std::nullopt;
  return lens;
}

/// Of the views, but for those of culprits.
double kept_share(const Observations& observations, const Part& part,
                  const std::optional<AdjustedPart>& solved) {
  if (!solved || solved->contradictions.are_there()) return 0.0;
  const auto offered = std::ranges::count_if(part.views, [&](std::size_t v) {
    return std::ranges::find(solved->culprits, observations.views[v].tag) == solved->culprits.end();
  });
  return static_cast<double>(solved->part.views.size()) / static_cast<double>(offered);
}

/// Of views that count: what hides under more noise is not explained by it.
double noise_of(const std::optional<AdjustedPart>& solved) {
  return solved ? std::hypot(solved->state.noise.sum, solved->state.noise.difference)
                : std::numeric_limits<double>::infinity();
}

/// Where the views contradict each other, or many were rejected, the focal length may be why: one that most
/// of them agree with, with no more than `noise`, if there is one.
std::optional<AdjustedPart> adjust_with_other_focal_length(const PartTask& task, const Part& part,
                                                           int held_tag, double share, double noise,
                                                           const ParallelFor& parallel) {
  std::optional<AdjustedPart> best;
  for (const double change : kOtherFocalLengths) {
    Observations other = task.observations;
    for (RigCamera& camera : other.cameras)
      camera = moved(camera, {.kind = CameraParameter::Kind::kFocalLength}, change);
    const std::vector<ViewCandidates> candidates = solve_views(other, part.views, parallel);
    try {
      AdjustedPart solved = adjust_part({other, candidates, task.options}, part, held_tag, parallel);
      const double of_this = kept_share(task.observations, part, solved);
      if (of_this < share + kClearlyMore || of_this < kMost || noise_of(solved) > noise) continue;
      share = of_this;
      best = std::move(solved);
    } catch (const Error&) {  // nor does this one fit
    }
  }
  return best;
}

/// No map can be held by a tag that all others contradict: throws Error(kNoResult) where the one that the
/// user holds is that.
void require_held_tag_that_fits(const PartTask& task, const Part& part, const Contradictions& contradictions,
                                int held_tag, const ParallelFor& parallel, const LogSink& log) {
  if (!is_held_by_wish(task, held_tag)) return;
  CalibrationOptions options = task.options;
  options.held_tag.reset();
  const PartTask any{task.observations, task.candidates, options};
  const auto rest = adjust_without_culprit(any, part, contradictions, held_tag, parallel, log);
  if (!rest || rest->culprits != std::vector{held_tag}) return;
  const auto finding = look_at(any, probe_views(any, part, *rest, held_tag), held_tag).finding;
  fail_by_held_tag(finding ? finding->words
                           : fmt::format("The views of {} contradict those of all others",
                                         to_string(*task.options.held_tag)));
}

AdjustedPart adjust_without_contradictions(const PartTask& task, const Part& part, int held_tag,
                                           const ParallelFor& parallel, const LogSink& log) {
  std::optional<Error> failure;
  std::optional<AdjustedPart> solved;
  try {
    solved = adjust_part(task, part, held_tag, parallel);
  } catch (const Error& error) {  // one tag may be the cause, or the camera file
    failure = error;
  }
  if (solved && !solved->contradictions.are_there() && kept_share(task.observations, part, solved) > kMost)
    return std::move(*solved);
  const Contradictions contradictions = solved ? solved->contradictions : Contradictions{};
  std::optional<AdjustedPart> without;
  if (failure || contradictions.are_there())
    without = adjust_without_culprit(task, part, contradictions, held_tag, parallel, log);
  if (!without && (failure || contradictions.are_there()))
    require_held_tag_that_fits(task, part, contradictions, held_tag, parallel, log);
  const double share =
      std::max(kept_share(task.observations, part, solved), kept_share(task.observations, part, without));
  if (task.options.intrinsics != Intrinsics::kKeep && share < kMost) {
    if (auto other = adjust_with_other_focal_length(task, part, held_tag, share, noise_of(solved), parallel))
      return std::move(*other);
  }
  if (without) return std::move(*without);
  if (failure) throw *failure;
  if (contradictions.are_there()) fail_with_contradictions(task.observations, contradictions);
  return std::move(*solved);
}

/// Each frame anew, the tags as they are.
void let_frames_follow(const Observations& observations, const Part& part, MapState& state) {
  constexpr int kMostSteps = 10;
  constexpr double kStill = 1e-10;  // m or rad
  for (int i = 0; i < kMostSteps; ++i) {
    const auto steps = solve_steps(corner_views(observations, part.views, state), std::nullopt);
    if (!steps) return;
    double largest = 0.0;
    for (const auto& [frame, step] : steps->frames) {
      Pose& pose = state.T_map_rig[static_cast<std::size_t>(frame)];
      pose = pose * Pose::exp(step);
      largest = std::max(largest, step.cwiseAbs().maxCoeff());
    }
    if (largest < kStill) return;
  }
}

/// joint: of the adjusted map.
void keep_to_constraints(const Observations& observations, const CovarianceOperator& joint,
                         PartSolution& solution) {
  ImageMap map{observations.tags, solution.part.tags, solution.held_tag, solution.state.T_map_tag, {}};
  const Pose T_held_map = map.T_held_tag[static_cast<std::size_t>(solution.held_tag)].inverse();
  for (Pose& pose : map.T_held_tag) pose = T_held_map * pose;
  for (const TagCovariance& tag : solution.covariances) map.covariances.push_back(tag.by_noise + tag.by_bias);
  solution.constrained = constrain_map(solution.constraints, map, joint);
  keep_to(solution.constrained->change, solution.joint);
  solution.state.T_map_tag = solution.constrained->T_map_tag;
  for (Pose& pose : solution.state.T_map_rig) pose = solution.constrained->T_map_held * T_held_map * pose;
  let_frames_follow(observations, solution.part, solution.state);
}

void measure_covariances(const Observations& observations, const CalibrationOptions& options,
                         const std::vector<MapConstraint>& constraints, PartSolution& solution) {
  if (solution.part.tags.size() > static_cast<std::size_t>(options.max_tags_with_covariance)) return;
  const std::vector<LinearView> views = corner_views(observations, solution.part.views, solution.state);
  const auto poses = PoseInformation::of(views, solution.part.tags, solution.held_tag);
  if (!poses)
    throw no_result("calibrate",
                    "the views leave the pose of a tag undetermined; film each tag from more sides, together "
                    "with others");
  const double bias = options.corner_bias_px / options.corner_sigma_px;
  solution.scale = error_scale(views, *poses, bias * bias);
  const auto shared = errors_of_cameras(observations, solution, views, *poses);
  solution.covariances = tag_covariances(*poses, solution.part.tags, shared);
  scale_by(solution.scale, solution.covariances);
  if (solution.part.tags.size() <= static_cast<std::size_t>(options.max_tags_with_joint_covariance)) {
    std::vector<TagKey> keys;
    for (const int tag : solution.part.tags) keys.push_back(observations.tags[static_cast<std::size_t>(tag)]);
    solution.joint =
        joint_tag_covariance(*poses, solution.part.tags, std::move(keys), solution.scale, shared);
  }
  if (constraints.empty()) return;
  solution.constraints = with_gravity_of_tags(constraints, observations, solution.part.views, views,
                                              solution.state, solution.scale);
  keep_to_constraints(observations, CovarianceOperator(*poses, solution.scale, shared), solution);
}

/// Lenses, edge offsets and places of cameras, where the views agree better with others.
void improve_cameras(const PartTask& task, const Part& part, AdjustedPart& solved, PartSolution& solution) {
  const Part to_map = without_left_out(task.observations, part, solved);
  solution.cameras = better_cameras(task, to_map, solved);
  solution.lens_not_taken = lens_not_taken(task, to_map, solved);
}

/// Looks at each tag for faults, and leaves out what cannot be trusted.
void leave_out_faulty(const PartTask& task, const Part& part, AdjustedPart& solved,
                      const ParallelFor& parallel, PartSolution& solution) {
  const std::vector<int> tags_before = solved.part.tags;
  solution.findings = examine_tags(task, part, solved, parallel);
  solution.contradicted = leave_out_contradicted(task, part, solved);
  if (solved.part.tags == tags_before) return;
  try {
    if (solution.contradicted.empty() && solved.contradictions.are_there())
      fail_with_contradictions(task.observations, solved.contradictions);
    // Without them, others' views may leave two poses that had one.
    leave_out_undecided(task, part, solved, parallel);
  } catch (const Error& error) {
    fail_after(solution.findings, error);
  }
}

void take_adjusted(AdjustedPart solved, PartSolution& solution) {
  solution.held_tag = solved.held_tag;
  solution.culprits = solved.culprits;
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
}

/// Those of the part that are not mapped, and were left out for no reason of their own.
std::vector<int> lost_tags(const Part& part, const PartSolution& solution) {
  std::set<int> explained(solution.undecided.begin(), solution.undecided.end());
  explained.insert(solution.contradicted.begin(), solution.contradicted.end());
  explained.insert(solution.culprits.begin(), solution.culprits.end());
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

}  // namespace

PartSolution solve_part(const Observations& observations, const Part& part, int held_tag,
                        const std::vector<ViewCandidates>& candidates, const CalibrationOptions& options,
                        const std::vector<MapConstraint>& constraints, const ParallelFor& parallel,
                        const LogSink& log) {
  const PartTask task{observations, candidates, options};
  AdjustedPart solved = adjust_without_contradictions(task, part, held_tag, parallel, log);
  leave_out_undecided(task, part, solved, parallel);
  PartSolution solution;
  improve_cameras(task, part, solved, solution);
  leave_out_faulty(task, part, solved, parallel, solution);
  take_adjusted(std::move(solved), solution);

  measure_covariances(observations, options, constraints, solution);
  measure_residuals(observations, solution);
  count_offered_views(observations, part, solution);
  solution.lost_tags = lost_tags(part, solution);
  require_sense(solution);
  return solution;
}

}  // namespace apriltrack
