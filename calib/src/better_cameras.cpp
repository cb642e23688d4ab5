#include "better_cameras.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>
#include <utility>

#include "agreeing_part.h"
#include "apriltrack/base/error.h"
#include "undecided_tags.h"

namespace apriltrack {
namespace {

constexpr double kClearGain = 0.05;  // of what was not asked for
constexpr double kOff = 1.0;         // sigmas of what files of the same camera are off by
constexpr double kFarOff = 3.0;
constexpr int kMostLenses = 4;

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
  const bool has_other_lens = std::ranges::any_of(cameras, [&](int camera) {
    const auto c = static_cast<std::size_t>(camera);
    return solved.state.cameras[c].model.pinhole().fx != task.observations.cameras[c].model.pinhole().fx;
  });
  CameraRefinement result;
  if (options.edge_offset_sigma_px > 0.0) {
    add(edge_offset_parameters(cameras, options.edge_offset_sigma_px));
    if (!has_other_lens) result = refine_cameras(task, part, parameters, 0.0, solved);
  }
  if (options.intrinsics == Intrinsics::kKeep && !options.refine_extrinsics) return result;
  if (options.intrinsics != Intrinsics::kKeep) add(intrinsic_parameters(cameras, task.observations.cameras));
  if (options.refine_extrinsics) add(extrinsic_parameters(cameras));
  if (has_other_lens) {
    CameraRefinement forced = refine_cameras(task, part, parameters, -1.0, solved);
    if (!forced.is_accepted)
      throw no_result("calibrate",
                      fmt::format("the views agree with a lens that is not the camera file's, but do not "
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

/// That were not asked for, and agree clearly better; `solved` is a copy.
std::optional<CameraRefinement> not_taken(const PartTask& task, const Part& part,
                                          const std::vector<CameraParameter>& parameters,
                                          AdjustedPart solved) {
  CameraRefinement better = refine_cameras(task, part, parameters, kClearGain, solved);
  if (!better.is_accepted) return std::nullopt;
  return better;
}

/// With all else that was estimated, or the places would take the blame for it.
std::optional<CameraRefinement> places_not_taken(const PartTask& task, const Part& part,
                                                 const CameraRefinement& refined,
                                                 const AdjustedPart& solved) {
  std::vector<CameraParameter> parameters = extrinsic_parameters(cameras_of(task.observations, solved.part));
  if (task.options.refine_extrinsics || parameters.empty()) return std::nullopt;
  for (const EstimatedParameter& one : refined.estimates) parameters.push_back(one.parameter);
  return not_taken(task, part, parameters, solved);
}

/// By how many sigmas of what files of the same camera are off by. Detectors' edges are in no file.
double sigmas_off(const EstimatedParameter& one) {
  return one.parameter.kind == CameraParameter::Kind::kEdgeOffset ? 0.0
                                                                  : std::abs(one.value) / one.parameter.sigma;
}

const EstimatedParameter& farthest_off(const CameraRefinement& cameras) {
  return *std::ranges::max_element(cameras.estimates, {},
                                   [](const EstimatedParameter& one) { return sigmas_off(one); });
}

double most_sigmas_off(const CameraRefinement& cameras) {
  return cameras.is_accepted ? sigmas_off(farthest_off(cameras)) : 0.0;
}

/// What is known before, as little as the file is wrong.
std::vector<CameraParameter> less_known_parameters(const CameraRefinement& cameras) {
  std::vector<CameraParameter> parameters;
  for (const EstimatedParameter& one : cameras.estimates) {
    parameters.push_back(one.parameter);
    parameters.back().sigma *= std::max(1.0, most_sigmas_off(cameras));
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
  throw no_result(
      "calibrate",
      fmt::format("the camera file is far off (its {} of {} by about {:.2g}, or more), and the views do not "
                  "tell what is right: is it of this camera, lens and picture size? Calibrate the camera, or "
                  "correct the file",
                  name_of(worst.parameter, camera), camera.name, worst.value));
}

/// The part, by the cameras as `solved` has them, and these refined once more.
struct Again {
  std::vector<ViewCandidates> candidates;
  AdjustedPart solved;
  CameraRefinement refined;
};

Again solve_again(const PartTask& task, const Part& part, const AdjustedPart& solved,
                  const CameraRefinement& cameras, const ParallelFor& parallel, const LogSink& log) {
  Observations by_cameras = task.observations;
  by_cameras.cameras = solved.state.cameras;
  std::vector<ViewCandidates> candidates = solve_views(by_cameras, part.views, parallel);
  const PartTask again{by_cameras, candidates, task.options};
  AdjustedPart anew = adjust_without_contradictions(again, part, solved.held_tag, parallel, log);
  leave_out_undecided(again, part, anew, parallel);
  CameraRefinement refined = refine_cameras(task, without_left_out(task.observations, part, anew),
                                            less_known_parameters(cameras), -1.0, anew);
  refined.held_out_before = cameras.held_out_before;
  refined.held_out_after = cameras.held_out_after;
  return {std::move(candidates), std::move(anew), std::move(refined)};
}

void solve_by_refined_cameras(const PartTask& task, const Part& part, const ParallelFor& parallel,
                              const LogSink& log, AdjustedPart& solved, BetterCameras& cameras) {
  if (most_sigmas_off(cameras.refined) < kOff) return;
  for (int i = 0; i < kMostLenses; ++i) {
    Again again = solve_again(task, part, solved, cameras.refined, parallel, log);
    if (!again.refined.is_accepted) {
      if (most_sigmas_off(cameras.refined) > kFarOff) fail_by_camera_file(task, cameras.refined);
      return;
    }
    const bool is_settled = are_about_the_same(cameras.refined, again.refined);
    cameras.refined = std::move(again.refined);
    cameras.candidates = std::move(again.candidates);
    solved = std::move(again.solved);
    if (is_settled) return;
  }
  fail_by_camera_file(task, cameras.refined);
}

}  // namespace

BetterCameras improve_cameras(const PartTask& task, const Part& part, const ParallelFor& parallel,
                              const LogSink& log, AdjustedPart& solved) {
  BetterCameras cameras;
  const Part to_map = without_left_out(task.observations, part, solved);
  cameras.refined = better_cameras(task, to_map, solved);
  solve_by_refined_cameras(task, part, parallel, log, solved, cameras);
  if (task.options.intrinsics == Intrinsics::kKeep)
    cameras.lens_not_taken = not_taken(
        task, to_map,
        intrinsic_parameters(cameras_of(task.observations, solved.part), task.observations.cameras), solved);
  cameras.places_not_taken = places_not_taken(task, to_map, cameras.refined, solved);
  return cameras;
}

}  // namespace apriltrack
