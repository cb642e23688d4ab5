#include "cameras/camera_refinement.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <utility>

#include "apriltrack/base/error.h"
#include "cameras/camera_trial.h"
#include "model/corner_views.h"
#include "solve/camera_fit.h"
#include "uncertainty/pose_information.h"

namespace apriltrack {
namespace {

constexpr double kWorthTrying = 0.001;
/// What nobody asked to change changes on very strong evidence alone: 150 to 1 (Kass and Raftery, JASA 90,
/// 1995, section 3.2). Frames that are held out from a film of one place keep the errors of the others, and
/// cannot tell.
constexpr double kLeastOdds = 150.0;

}  // namespace

CameraParameters parameters_of(const CameraRefinement& cameras) {
  CameraParameters parameters;
  for (const EstimatedParameter& one : cameras.estimates) parameters.push_back(one.parameter);
  return parameters;
}

std::vector<int> cameras_of(const Observations& observations, const Part& part) {
  std::set<int> cameras;
  for (const std::size_t v : part.views) cameras.insert(observations.views[v].camera);
  return {cameras.begin(), cameras.end()};
}

std::vector<ParameterView> independent_errors(const Observations& observations,
                                              const std::vector<std::size_t>& views, const MapState& state,
                                              const CameraRefinement& estimated) {
  CameraParameters parameters = parameters_of(estimated);
  for (CameraParameter& one : parameters) one.sigma = 1.0;
  return with_independent_errors(camera_columns(observations, views, state, parameters),
                                 estimated.covariance);
}

CameraRefinement refine_cameras(const PartTask& task, const Part& part, const CameraParameters& parameters,
                                double least_gain, AdjustedPart& solved, const ParallelFor& parallel) {
  CameraRefinement result;
  const auto most_tags = static_cast<std::size_t>(task.options.max_tags_with_covariance);
  if (solved.part.tags.size() > most_tags) {  // all poses follow the cameras by one dense system
    result.reason =
        fmt::format("maps of more than {} tags keep their cameras (max_tags_with_covariance)", most_tags);
    return result;
  }
  const bool is_forced = least_gain < 0.0;
  CameraFit fit(task, parameters, solved.part, solved.held_tag, solved.state);
  if (!is_forced && fit.promised_gain() < std::max(least_gain, kWorthTrying)) {
    result.reason = "no better cameras are in sight";
    return result;
  }
  if (!fit.run()) {
    result.reason = "the views do not determine them";
    return result;
  }
  if (!is_forced) {
    const CameraTrial trial = try_cameras(task, parameters, least_gain, solved, fit.state(), parallel);
    result.reason = trial.reason;
    result.held_out_before = trial.held_out_before;
    result.held_out_after = trial.held_out_after;
    if (!trial.is_passed) return result;
  }
  const double log_odds = least_gain > 0.0 ? fit.log_odds_of_change(solved.state) : 0.0;
  if (least_gain > 0.0 && !(log_odds >= std::log(kLeastOdds))) {
    result.reason =
        fmt::format("odds of {:.2g} to 1 that the camera file is off, and it stays up to {:.0f} to 1",
                    std::exp(log_odds), kLeastOdds);
    return result;
  }
  AdjustedPart refined = solved;
  refined.state = fit.state();
  Outcome<Part> kept = adjust_cleanly(task, part, solved.held_tag, refined.state);
  if (!kept) {
    result.reason = fmt::format("with them there is no map: {}", kept.why().cause);
    return result;
  }
  refined.part = std::move(*kept);
  CameraEstimates estimates = fit.estimates();
  result.estimates = std::move(estimates.parameters);
  result.covariance = std::move(estimates.covariance);
  result.is_accepted = true;
  solved = std::move(refined);
  return result;
}

std::optional<CameraRefinement> open_parameters(const CameraFit& fit, const IsAsked& is_asked) {
  auto found = fit.look(is_asked);
  if (!found) return std::nullopt;
  CameraRefinement open;
  open.estimates = std::move(found->parameters);
  Eigen::VectorXd values(static_cast<Eigen::Index>(open.estimates.size()));
  for (Eigen::Index i = 0; i < values.size(); ++i)
    values[i] = open.estimates[static_cast<std::size_t>(i)].value;
  open.covariance = found->covariance + values * values.transpose();
  return open;
}

std::optional<CameraRefinement> open_parameters(const PartTask& task, const CameraParameters& parameters,
                                                const AdjustedPart& solved) {
  const auto most_tags = static_cast<std::size_t>(task.options.max_tags_with_covariance);
  if (parameters.empty() || solved.part.tags.size() > most_tags) return std::nullopt;
  return open_parameters({task, parameters, solved.part, solved.held_tag, solved.state},
                         [](const CameraParameter&) { return true; });
}

}  // namespace apriltrack
