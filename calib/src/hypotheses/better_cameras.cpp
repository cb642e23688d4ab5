#include "hypotheses/better_cameras.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>
#include <utility>

#include "apriltrack/base/error.h"
#include "apriltrack/base/parallel.h"
#include "apriltrack/calib/calibration_options.h"
#include "cameras/open_cameras.h"
#include "hypotheses/undecided_tags.h"
#include "initialise/part_adjustment.h"

namespace apriltrack {
namespace {

constexpr double kClearGain = 0.05;  // of what was not asked for
constexpr double kOff = 1.0;         // sigmas of what files of the same camera are off by
constexpr double kFarOff = 3.0;
constexpr int kMostLenses = 4;
constexpr double kNothingHeldOut = -1.0;

/// What may be mapped still.
Part without_left_out(const Observations& observations, const Part& part, const AdjustedPart& solved) {
  const std::set<int> out = tags_left_out(solved);
  Part rest{{}, views_without(observations, part, out)};
  std::ranges::set_difference(part.tags, out, std::back_inserter(rest.tags));
  return rest;
}

/// Of the cameras that were not started with the file's lens: the file's is no choice, so nothing is held
/// out.
CameraRefinement refine_other_lenses(const PartTask& task, const Part& part, const CameraParameters& edges,
                                     const std::vector<int>& cameras, AdjustedPart& solved,
                                     const ParallelFor& parallel) {
  CameraRefinement refined =
      refine_cameras(task, part, edges + intrinsic_parameters(cameras, task.observations.cameras),
                     kNothingHeldOut, solved, parallel);
  if (!refined.is_accepted)
    throw no_result(
        "calibrate",
        fmt::format("the tags and the map agree with a lens that is not the camera file's, but it cannot "
                    "be estimated ({}): is the file of this camera, lens and picture size?",
                    refined.reason));
  return refined;
}

/// Edge offsets alone first, which are most often what is wrong with corners from elsewhere; then lenses, and
/// cameras' places.
CameraRefinement better_cameras(const PartTask& task, const Part& part, AdjustedPart& solved,
                                const ParallelFor& parallel) {
  const CalibrationOptions& options = task.options;
  const std::vector<int> cameras = cameras_of(task.observations, solved.part);
  std::vector<int> others;
  std::ranges::copy_if(cameras, std::back_inserter(others), [&](int camera) {
    return has_other_lens(solved.state.cameras[static_cast<std::size_t>(camera)],
                          task.observations.cameras[static_cast<std::size_t>(camera)]);
  });
  const bool has_edges = options.edge_offset_sigma_px > 0.0;
  CameraParameters parameters =
      has_edges ? edge_offset_parameters(cameras, options.edge_offset_sigma_px) : CameraParameters{};
  CameraRefinement first;
  if (!others.empty())
    first = refine_other_lenses(task, part, parameters, others, solved, parallel);
  else if (has_edges)
    first = refine_cameras(task, part, parameters, 0.0, solved, parallel);
  const bool keeps_lenses = options.intrinsics == Intrinsics::kKeep;
  if (!keeps_lenses) parameters = parameters + intrinsic_parameters(cameras, task.observations.cameras);
  if (options.refine_extrinsics) parameters = parameters + extrinsic_parameters(cameras);
  if ((keeps_lenses && !options.refine_extrinsics) || parameters.size() == first.estimates.size())
    return first;
  const bool is_asked_for = options.intrinsics == Intrinsics::kRefine || options.refine_extrinsics;
  // The prior pulls at a lens that is far from the file's, until all is done again: others would make up for
  // it.
  if (!others.empty() && !is_asked_for) return first;
  CameraRefinement of_all =
      refine_cameras(task, part, parameters, is_asked_for ? 0.0 : kClearGain, solved, parallel);
  if (of_all.is_accepted || !first.is_accepted) return of_all;
  first.reason = of_all.reason;
  return first;
}

/// That were not asked for, and agree clearly better; `solved` is a copy.
std::optional<CameraRefinement> not_taken(const PartTask& task, const Part& part,
                                          const CameraParameters& parameters, AdjustedPart solved,
                                          const ParallelFor& parallel) {
  CameraRefinement better = refine_cameras(task, part, parameters, kClearGain, solved, parallel);
  if (!better.is_accepted) return std::nullopt;
  return better;
}

/// With all else that was estimated, or the places would take the blame for it.
std::optional<CameraRefinement> places_not_taken(const PartTask& task, const Part& part,
                                                 const CameraRefinement& refined, const AdjustedPart& solved,
                                                 const ParallelFor& parallel) {
  const CameraParameters parameters = extrinsic_parameters(cameras_of(task.observations, solved.part));
  if (task.options.refine_extrinsics || parameters.empty()) return std::nullopt;
  return not_taken(task, part, parameters + parameters_of(refined), solved, parallel);
}

/// By how many sigmas of what files of the same camera are off by. Detectors' edges are in no file.
double sigmas_off(const EstimatedParameter& one) {
  if (one.parameter.kind == CameraParameter::Kind::kEdgeOffset) return 0.0;
  return std::abs(one.value) / one.parameter.sigma * one.parameter.widened;
}

const EstimatedParameter& farthest_off(const CameraRefinement& cameras) {
  return *std::ranges::max_element(cameras.estimates, {},
                                   [](const EstimatedParameter& one) { return sigmas_off(one); });
}

double most_sigmas_off(const CameraRefinement& cameras) {
  return cameras.is_accepted ? sigmas_off(farthest_off(cameras)) : 0.0;
}

/// As little as the file is wrong about the same camera's lens, or its place. Edges are in no file.
CameraParameters less_known_parameters(const CameraRefinement& cameras) {
  const auto is_alike = [](const CameraParameter& a, const CameraParameter& b) {
    return a.camera == b.camera &&
           ((a.is_of_lens() && b.is_of_lens()) || (a.is_of_place() && b.is_of_place()));
  };
  CameraParameters parameters;
  for (const EstimatedParameter& one : cameras.estimates) {
    double widened = 1.0;
    for (const EstimatedParameter& other : cameras.estimates)
      if (is_alike(one.parameter, other.parameter)) widened = std::max(widened, sigmas_off(other));
    parameters.push_back(one.parameter);
    parameters.back().sigma *= widened / parameters.back().widened;
    parameters.back().widened = widened;
  }
  return parameters;
}

bool are_about_the_same(const CameraRefinement& before, const CameraRefinement& after) {
  return std::ranges::equal(before.estimates, after.estimates,
                            [](const EstimatedParameter& a, const EstimatedParameter& b) {
                              return std::abs(b.value - a.value) <= b.sigma;
                            });
}

[[noreturn]] void fail_by_camera_file(const PartTask& task, const CameraRefinement& cameras) {
  const EstimatedParameter& worst = farthest_off(cameras);
  const RigCamera& camera = task.observations.cameras[static_cast<std::size_t>(worst.parameter.camera)];
  const bool is_of_place = worst.parameter.is_of_place();
  const std::string unit = unit_of(worst.parameter);
  throw no_result(
      "calibrate",
      fmt::format(
          "the camera file is far off (its {} of {} by about {:.2g} {}, or more), and the views do not "
          "tell what is right: is it of this {}? Calibrate the {}, or correct the file",
          name_of(worst.parameter, camera), camera.name, worst.value, unit == "1" ? "(a share)" : unit,
          is_of_place ? "rig, with its cameras in this order" : "camera, lens and picture size",
          is_of_place ? "rig" : "camera"));
}

/// The test that they stood, and why others did not, where they are estimated anew without it.
void keep_test_of(const CameraRefinement& before, CameraRefinement& anew) {
  anew.held_out_before = before.held_out_before;
  anew.held_out_after = before.held_out_after;
  anew.reason = before.reason;
}

/// The part, by the cameras as `solved` has them, and these refined once more.
struct Again {
  std::vector<ViewCandidates> candidates;
  AdjustedPart solved;
  CameraRefinement refined;
};

/// nullopt where they give no map. Tags that were undecided are asked again.
std::optional<Again> solve_again(const PartTask& task, const Part& part, const AdjustedPart& solved,
                                 const CameraRefinement& cameras, const ParallelFor& parallel) {
  Observations by_cameras = task.observations;
  by_cameras.cameras = solved.state.cameras;
  std::vector<ViewCandidates> candidates = solve_views(by_cameras, part.views, parallel);
  const PartTask again{by_cameras, candidates, task.options};
  std::set<int> gone;
  for (const TagFinding& finding : solved.findings)
    if (finding.is_left_out) gone.insert(finding.tag);
  const Part seen = with_poses(again,
                               connected_to(by_cameras, views_without(by_cameras, part, gone),
                                            solved.held_tag, task.options.min_views),
                               solved.held_tag);
  Outcome<AdjustedPart> anew = adjust_part(again, seen, solved.held_tag, parallel);
  if (!anew) return std::nullopt;
  anew->findings = solved.findings;
  if (leave_out_undecided(again, seen, *anew, parallel)) return std::nullopt;
  CameraRefinement refined = refine_cameras(task, without_left_out(task.observations, seen, *anew),
                                            less_known_parameters(cameras), kNothingHeldOut, *anew, parallel);
  if (!refined.is_accepted) return std::nullopt;
  keep_test_of(cameras, refined);
  return Again{std::move(candidates), std::move(*anew), std::move(refined)};
}

/// Until they stay. What is about right stays as it was.
void solve_by_refined_cameras(const PartTask& task, const Part& part, const ParallelFor& parallel,
                              AdjustedPart& solved, BetterCameras& cameras) {
  if (!is_far_from_file(cameras.refined)) return;
  for (int i = 0; i < kMostLenses; ++i) {
    std::optional<Again> again = solve_again(task, part, solved, cameras.refined, parallel);
    if (!again) break;
    const bool is_settled = are_about_the_same(cameras.refined, again->refined);
    cameras.refined = std::move(again->refined);
    cameras.candidates = std::move(again->candidates);
    solved = std::move(again->solved);
    if (is_settled) return;
  }
  if (most_sigmas_off(cameras.refined) > kFarOff) fail_by_camera_file(task, cameras.refined);
}

/// Those whose lenses had to wait until others were right. Whether any is taken over.
bool refine_other_cameras(const PartTask& task, const Part& part, const ParallelFor& parallel,
                          AdjustedPart& solved, CameraRefinement& refined) {
  if (task.options.intrinsics == Intrinsics::kKeep || !refined.is_accepted) return false;
  std::vector<int> waiting = cameras_of(task.observations, solved.part);
  const CameraParameters parameters = parameters_of(refined);
  if (std::ranges::none_of(parameters, &CameraParameter::is_of_lens)) return false;
  for (const CameraParameter& one : parameters)
    if (one.is_of_lens()) std::erase(waiting, one.camera);
  if (waiting.empty()) return false;
  CameraRefinement all = refine_cameras(task, without_left_out(task.observations, part, solved),
                                        parameters + intrinsic_parameters(waiting, task.observations.cameras),
                                        kClearGain, solved, parallel);
  if (!all.is_accepted) return false;
  refined = std::move(all);
  return true;
}

/// What the user's own choices keep out, though the views agree better with it, and what is left open.
void find_what_is_not_taken(const PartTask& task, const Part& to_map, const AdjustedPart& solved,
                            const ParallelFor& parallel, BetterCameras& cameras) {
  cameras.lens_not_taken = cameras.places_not_taken = std::nullopt;
  cameras.open = find_open_cameras(task, cameras.refined, solved);
  if (task.options.intrinsics == Intrinsics::kKeep)
    cameras.lens_not_taken =
        not_taken(task, to_map,
                  intrinsic_parameters(cameras_of(task.observations, solved.part), task.observations.cameras),
                  solved, parallel);
  if (!cameras.lens_not_taken)
    cameras.places_not_taken = places_not_taken(task, to_map, cameras.refined, solved, parallel);
  // What frames do tell is open all the more, though to first order it may look as expected.
  if (!cameras.open && cameras.places_not_taken)
    cameras.open = open_parameters(task, parameters_of(*cameras.places_not_taken), solved);
}

/// Lenses and places that are not among what is refined: what is left out now may have hidden them.
void refine_more(const PartTask& task, const Part& rest, const ParallelFor& parallel, AdjustedPart& solved,
                 CameraRefinement& refined) {
  const auto& [observations, candidates, options] = task;
  const CameraParameters known = parameters_of(refined);
  const std::vector<int> cameras = cameras_of(observations, solved.part);
  CameraParameters all = known;
  if (options.intrinsics != Intrinsics::kKeep && std::ranges::none_of(known, &CameraParameter::is_of_lens))
    all = all + intrinsic_parameters(cameras, observations.cameras);
  if (options.refine_extrinsics && std::ranges::none_of(known, &CameraParameter::is_of_place))
    all = all + extrinsic_parameters(cameras);
  if (all.size() == known.size()) return;
  const bool is_asked_for = options.intrinsics == Intrinsics::kRefine || options.refine_extrinsics;
  CameraRefinement more = refine_cameras(task, rest, all, is_asked_for ? 0.0 : kClearGain, solved, parallel);
  if (more.is_accepted)
    refined = std::move(more);
  else
    refined.reason = more.reason;
}

/// What is known of the cameras is estimated anew, or found for the first time.
void refine_again(const PartTask& task, const Part& rest, const ParallelFor& parallel, AdjustedPart& solved,
                  CameraRefinement& refined) {
  if (!refined.is_accepted) {
    refined = better_cameras(task, rest, solved, parallel);
    return;
  }
  CameraRefinement again =
      refine_cameras(task, rest, parameters_of(refined), kNothingHeldOut, solved, parallel);
  if (!again.is_accepted) return;
  keep_test_of(refined, again);
  refined = std::move(again);
  refine_more(task, rest, parallel, solved, refined);
}

void add_to(std::vector<int>& tags, const std::vector<int>& more) {
  std::ranges::copy_if(more, std::back_inserter(tags),
                       [&](int tag) { return std::ranges::find(tags, tag) == tags.end(); });
}

}  // namespace

bool is_far_from_file(const CameraRefinement& cameras) {
  return most_sigmas_off(cameras) >= kOff;
}

BetterCameras improve_cameras(const PartTask& task, const Part& part, const ParallelFor& parallel,
                              AdjustedPart& solved) {
  BetterCameras cameras;
  cameras.refined = better_cameras(task, without_left_out(task.observations, part, solved), solved, parallel);
  solve_by_refined_cameras(task, part, parallel, solved, cameras);
  if (refine_other_cameras(task, part, parallel, solved, cameras.refined))
    solve_by_refined_cameras(task, part, parallel, solved, cameras);
  find_what_is_not_taken(task, without_left_out(task.observations, part, solved), solved, parallel, cameras);
  return cameras;
}

void improve_cameras_again(const PartTask& task, const Part& part, const ParallelFor& parallel,
                           AdjustedPart& solved, BetterCameras& cameras) {
  const Part rest = narrowed_to(task.observations, part, solved.part.tags);
  const std::size_t num_before = cameras.refined.estimates.size();
  const std::vector<int> undecided = solved.undecided;
  refine_again(task, rest, parallel, solved, cameras.refined);
  if (cameras.refined.estimates.size() > num_before)
    solve_by_refined_cameras(task, rest, parallel, solved, cameras);
  add_to(solved.undecided, undecided);  // the rest knows nothing of them
  find_what_is_not_taken(task, rest, solved, parallel, cameras);
}

}  // namespace apriltrack
