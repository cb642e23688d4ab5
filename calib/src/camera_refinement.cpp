#include "camera_refinement.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <utility>

#include "apriltrack/base/error.h"
#include "block_scatter.h"
#include "bundle_adjustment.h"
#include "corner_views.h"
#include "error_scale.h"
#include "normal_distribution.h"

namespace apriltrack {
namespace {

constexpr int kMaxSteps = 8;
constexpr double kSettled = 0.02;  // of a standard deviation
constexpr int kFramesOfGroup = 5;  // neighbours repeat their errors: they are held out together
constexpr int kHeldOut = 4;        // every so many groups, one
constexpr int kLeastGroups = 3;    // of those held out
constexpr int kEnoughGroups = 10;  // where one fold has fewer, all are held out in turn
constexpr double kWorthTrying = 0.001;
constexpr double kClear = 2.0;              // standard deviations, of a normal distribution
constexpr double kMostOfView = 8.0 * 16.0;  // a view counts no more than at four sigmas

struct Split {
  std::vector<std::size_t> others, held_out;
  std::map<int, int> group_of_frame;
};

/// By the rank of their frames in time. fold: which of the groups are held out.
Split split(const Observations& observations, const std::vector<std::size_t>& views, int fold) {
  Split result;
  int rank = -1, last_frame = -1;
  for (const std::size_t v : views) {
    if (observations.views[v].frame != last_frame) ++rank;
    last_frame = observations.views[v].frame;
    const int group = result.group_of_frame[last_frame] = rank / kFramesOfGroup;
    const bool is_held_out = group % kHeldOut == fold;
    (is_held_out ? result.held_out : result.others).push_back(v);
  }
  return result;
}

/// Cameras and poses together: a step of the cameras with all poses following, then the poses alone, until
/// neither moves.
class Fit {
 public:
  Fit(const PartTask& task, const std::vector<CameraParameter>& parameters, Part part, int held_tag)
      : task_(task), parameters_(parameters), part_(std::move(part)), held_tag_(held_tag) {}

  /// False where it does not settle.
  bool run(MapState& state) {
    total_ = already_moved(state);
    step_number_ = 0;
    for (int i = 0; i < kMaxSteps; ++i) {
      const auto step = step_of_cameras(state);
      if (!step || !move(*step, state)) return false;
      const AdjustmentSummary summary = adjust(task_.observations, part_.views, free_tags(part_, held_tag_),
                                               adjustment_options(task_.options), state);
      if (!summary.is_usable || !summary.has_converged) return false;
      if (step->cwiseQuotient(sigmas_).cwiseAbs().maxCoeff() < kSettled) return true;
    }
    return false;
  }

  /// How far from the cameras as they are they would go, to first order.
  std::optional<std::vector<EstimatedParameter>> look(const MapState& state) {
    total_ = already_moved(state);
    step_number_ = 0;
    const auto step = step_of_cameras(state);
    if (!step) return std::nullopt;
    total_ = *step;
    return estimates();
  }

  std::vector<EstimatedParameter> estimates() const {
    std::vector<EstimatedParameter> result;
    for (std::size_t i = 0; i < parameters_.size(); ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      result.push_back({parameters_[i], total_[k] * parameters_[i].sigma, sigmas_[k] * parameters_[i].sigma});
    }
    return result;
  }

  /// Of the estimates, in their units.
  Eigen::MatrixXd covariance() const {
    Eigen::VectorXd units(covariance_.rows());
    for (Eigen::Index i = 0; i < units.size(); ++i) units[i] = parameters_[static_cast<std::size_t>(i)].sigma;
    return units.asDiagonal() * covariance_ * units.asDiagonal();
  }

 private:
  /// What was found before is part of what is estimated now.
  Eigen::VectorXd already_moved(const MapState& state) const {
    Eigen::VectorXd total(static_cast<Eigen::Index>(parameters_.size()));
    for (std::size_t i = 0; i < parameters_.size(); ++i) {
      const auto camera = static_cast<std::size_t>(parameters_[i].camera);
      total[static_cast<Eigen::Index>(i)] =
          difference(task_.observations.cameras[camera], state.cameras[camera], parameters_[i]) /
          parameters_[i].sigma;
    }
    return total;
  }

  /// In units of the parameters' sigmas.
  std::optional<Eigen::VectorXd> step_of_cameras(const MapState& state) {
    const std::vector<LinearView> views = corner_views(task_.observations, part_.views, state);
    const auto poses = PoseInformation::of(views, part_.tags, held_tag_);
    if (!poses || views.size() != part_.views.size()) return std::nullopt;
    const std::vector<ParameterView> columns =
        camera_columns(task_.observations, part_.views, state, parameters_);
    const ParameterInformation of_cameras = poses->eliminate_poses(columns);
    if (step_number_++ < 2) {  // then it stays, or prior and views would pull to and fro
      const double bias = task_.options.corner_bias_px / task_.options.corner_sigma_px;
      scale_ = error_scale(views, *poses, bias * bias);
      noise_variance_ =
          scale_.noise_variance *
          BlockScatter(views, *poses).parameters_factor(columns, of_cameras, scale_.noise_variance);
    }
    const Eigen::Index num = total_.size();
    // Errors that tags keep weigh as if they were so much more noise.
    Eigen::MatrixXd spread = noise_variance_ * of_cameras.information;
    for (const auto& [tag, gradient] : of_cameras.gradient_by_errors)
      spread += scale_.bias_variance * gradient * gradient.transpose();
    const Eigen::LDLT<Eigen::MatrixXd> alone(of_cameras.information +
                                             1e-9 * Eigen::MatrixXd::Identity(num, num));
    const Eigen::MatrixXd covariance = alone.solve(alone.solve(spread).transpose());
    const Eigen::VectorXd estimate = total_ - alone.solve(of_cameras.gradient);
    // With what was known before: mean 0, variance 1.
    const Eigen::LDLT<Eigen::MatrixXd> both(covariance + Eigen::MatrixXd::Identity(num, num));
    const Eigen::VectorXd target = both.solve(estimate);  // prior (prior + covariance)^-1 estimate
    covariance_ = Eigen::MatrixXd::Identity(num, num) - both.solve(Eigen::MatrixXd::Identity(num, num));
    sigmas_ = covariance_.diagonal().cwiseMax(1e-16).cwiseSqrt();
    if (!target.allFinite()) return std::nullopt;
    return target - total_;
  }

  bool move(const Eigen::VectorXd& step, MapState& state) {
    try {
      for (std::size_t i = 0; i < parameters_.size(); ++i) {
        RigCamera& camera = state.cameras[static_cast<std::size_t>(parameters_[i].camera)];
        camera = moved(camera, parameters_[i], step[static_cast<Eigen::Index>(i)] * parameters_[i].sigma);
      }
    } catch (const Error&) {  // a lens that no formula describes
      return false;
    }
    total_ = already_moved(state);  // shares of a focal length multiply
    return true;
  }

  const PartTask& task_;
  const std::vector<CameraParameter>& parameters_;
  Part part_;
  int held_tag_;
  Eigen::VectorXd total_, sigmas_;
  Eigen::MatrixXd covariance_;
  ErrorScale scale_;
  double noise_variance_ = 1.0;  ///< As the parameters of cameras follow it.
  int step_number_ = 0;
};

/// For frames' poses, whose squares are compared with others that end alike.
AdjustmentOptions nearly_settled(const PartTask& task) {
  AdjustmentOptions how = adjustment_options(task.options);
  how.ends_early = true;
  return how;
}

/// Squared disagreement of each group of frames, their poses fitted to the map as it is; nullopt where these
/// do not settle.
std::optional<std::map<int, double>> disagreements(const PartTask& task,
                                                   const std::vector<std::size_t>& views, MapState state) {
  const AdjustmentSummary summary = adjust(task.observations, views, {}, nearly_settled(task), state);
  if (!summary.is_usable || !summary.has_converged) return std::nullopt;
  std::map<int, double> of_frames;
  for (const std::size_t v : views) {
    bool is_valid = false;
    const Vector8d residual =
        whitened_residual(task.observations, task.observations.views[v], state, is_valid);
    of_frames[task.observations.views[v].frame] +=
        is_valid ? std::min(kMostOfView, residual.squaredNorm()) : kMostOfView;
  }
  return of_frames;
}

/// Squared disagreement of neighbouring frames that are held out together, appended to `sums`.
void add_groups(const std::map<int, double>& of_frames, const std::map<int, int>& group_of_frame,
                std::vector<double>& sums) {
  std::map<int, double> of_groups;
  for (const auto& [frame, squares] : of_frames) of_groups[group_of_frame.at(frame)] += squares;
  for (const auto& [group, squares] : of_groups) sums.push_back(squares);
}

/// Whether groups fall by more than chance: their logarithms, for one that is far off outweighs all others.
bool is_clearly_less(const std::vector<double>& before, const std::vector<double>& after) {
  constexpr double kLeast = 1e-9;
  const auto num = static_cast<double>(before.size());
  double sum = 0.0, squares = 0.0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const double gain = std::log((before[i] + kLeast) / (after[i] + kLeast));
    sum += gain;
    squares += gain * gain;
  }
  const double variance_of_mean = (squares - sum * sum / num) / (num * (num - 1.0));
  return sum / num > student_place(kClear, num - 1.0) * std::sqrt(std::max(0.0, variance_of_mean));
}

/// The share by which the residuals would fall, to first order.
double promised_gain(const PartTask& task, const std::vector<CameraParameter>& parameters,
                     const AdjustedPart& solved) {
  const std::vector<LinearView> views = corner_views(task.observations, solved.part.views, solved.state);
  const auto poses = PoseInformation::of(views, solved.part.tags, solved.held_tag);
  if (!poses || views.size() != solved.part.views.size()) return 0.0;
  const ParameterInformation of_cameras =
      poses->eliminate_poses(camera_columns(task.observations, solved.part.views, solved.state, parameters));
  const auto num = static_cast<Eigen::Index>(parameters.size());
  const Eigen::VectorXd step =
      (of_cameras.information + Eigen::MatrixXd::Identity(num, num)).ldlt().solve(of_cameras.gradient);
  double squares = 0.0;
  for (const LinearView& view : views) squares += view.residual.squaredNorm();
  return 1.0 - std::sqrt(std::max(0.0, 1.0 - of_cameras.gradient.dot(step) / std::max(squares, 1e-12)));
}

/// How much frames disagree that a map was not made from, by groups: with the cameras as they are, and with
/// cameras refined from the same frames as the map.
struct HeldOut {
  std::vector<double> before, after;
  std::size_t num_views = 0;

  double rms(const std::vector<double>& sums) const {
    return std::sqrt(std::reduce(sums.begin(), sums.end()) / (8.0 * static_cast<double>(num_views)));
  }
  bool is_clearly_better() const {
    return before.size() >= kLeastGroups && rms(after) < rms(before) && is_clearly_less(before, after);
  }
};

/// That the test was not passed.
std::string why_not(const HeldOut& held_out, double least_gain) {
  const double before = held_out.rms(held_out.before), after = held_out.rms(held_out.after);
  const std::string figures = fmt::format("({:.3f} sigmas before, {:.3f} after)", before, after);
  if (held_out.before.size() < kLeastGroups)
    return fmt::format(
        "too few frames to hold some out: of {} groups of {} neighbours there are {}; film more",
        kLeastGroups, kFramesOfGroup, held_out.before.size());
  if (after >= before) return "frames that were held out agree no better " + figures;
  if (!held_out.is_clearly_better())
    return "frames that were held out agree better by no more than chance " + figures;
  return fmt::format("frames that were held out agree better, but by less than {:.0f} % {}",
                     100.0 * least_gain, figures);
}

/// Why not, where it cannot be done.
std::optional<std::string> hold_out(const PartTask& task, const std::vector<CameraParameter>& parameters,
                                    const AdjustedPart& solved, int fold, HeldOut& result) {
  Split views = split(task.observations, solved.part.views, fold);
  const Part others = connected_to(task.observations, views.others, solved.held_tag, task.options.min_views);
  std::erase_if(views.held_out, [&](std::size_t v) {
    return !std::ranges::binary_search(others.tags, task.observations.views[v].tag);
  });
  if (others.tags.size() < 2 || views.held_out.empty()) return "too few frames to hold some out";
  MapState before = solved.state;
  const AdjustmentSummary summary =
      adjust(task.observations, others.views, free_tags(others, solved.held_tag),
             adjustment_options(task.options), before);
  if (!summary.is_usable || !summary.has_converged)
    return "the map without the held-out frames does not settle";
  MapState after = before;
  if (!Fit(task, parameters, others, solved.held_tag).run(after)) return "the views do not determine them";
  const auto squares_before = disagreements(task, views.held_out, before);
  const auto squares_after = disagreements(task, views.held_out, after);
  if (!squares_before || !squares_after) return "the held-out frames' poses do not settle";
  add_groups(*squares_before, views.group_of_frame, result.before);
  add_groups(*squares_after, views.group_of_frame, result.after);
  result.num_views += views.held_out.size();
  return std::nullopt;
}

bool stands_the_test(const PartTask& task, const std::vector<CameraParameter>& parameters, double least_gain,
                     const AdjustedPart& solved, CameraRefinement& result) {
  HeldOut held_out;
  std::optional<std::string> failure;
  for (int fold = kHeldOut - 1; fold >= 0 && held_out.before.size() < kEnoughGroups; --fold)
    if (auto reason = hold_out(task, parameters, solved, fold, held_out)) failure = std::move(reason);
  if (held_out.num_views == 0) {
    result.reason = *failure;
    return false;
  }
  result.held_out_before = held_out.rms(held_out.before);
  result.held_out_after = held_out.rms(held_out.after);
  if (held_out.is_clearly_better() && result.held_out_after <= (1.0 - least_gain) * result.held_out_before)
    return true;
  result.reason = why_not(held_out, least_gain);
  return false;
}

}  // namespace

std::vector<ParameterView> independent_errors(const Observations& observations,
                                              const std::vector<std::size_t>& views, const MapState& state,
                                              const CameraRefinement& estimated) {
  std::vector<CameraParameter> parameters;
  for (const EstimatedParameter& one : estimated.estimates) {
    parameters.push_back(one.parameter);
    parameters.back().sigma = 1.0;
  }
  return with_independent_errors(camera_columns(observations, views, state, parameters),
                                 estimated.covariance);
}

CameraRefinement refine_cameras(const PartTask& task, const Part& part,
                                const std::vector<CameraParameter>& parameters, double least_gain,
                                AdjustedPart& solved, const ParallelFor& parallel) {
  CameraRefinement result;
  const auto most_tags = static_cast<std::size_t>(task.options.max_tags_with_covariance);
  if (solved.part.tags.size() > most_tags) {  // all poses follow the cameras by one dense system
    result.reason =
        fmt::format("maps of more than {} tags keep their cameras (max_tags_with_covariance)", most_tags);
    return result;
  }
  const bool is_forced = least_gain < 0.0;
  if (!is_forced && promised_gain(task, parameters, solved) < std::max(least_gain, kWorthTrying)) {
    result.reason = "no better cameras are in sight";
    return result;
  }
  AdjustedPart refined = solved;
  Fit fit(task, parameters, solved.part, solved.held_tag);
  std::atomic<bool> stands = true;
  bool is_determined = false;
  parallel(2, [&](std::size_t i) {  // most that are tested stand: the fit need not wait
    if (i == 0)
      stands = is_forced || stands_the_test(task, parameters, least_gain, solved, result);
    else
      is_determined = stands && fit.run(refined.state);
  });
  if (!stands) return result;
  if (!is_determined) {
    result.reason = "the views do not determine them";
    return result;
  }
  try {
    refined.part = adjust_cleanly(task, part, solved.held_tag, refined.state);
  } catch (const Error& error) {
    result.reason = fmt::format("with them there is no map: {}", error.what());
    return result;
  }
  result.estimates = fit.estimates();
  result.covariance = fit.covariance();
  result.is_accepted = true;
  solved = std::move(refined);
  return result;
}

std::optional<CameraRefinement> open_parameters(const PartTask& task,
                                                const std::vector<CameraParameter>& parameters,
                                                const AdjustedPart& solved) {
  const auto most_tags = static_cast<std::size_t>(task.options.max_tags_with_covariance);
  if (parameters.empty() || solved.part.tags.size() > most_tags) return std::nullopt;
  Fit fit(task, parameters, solved.part, solved.held_tag);
  auto steps = fit.look(solved.state);
  if (!steps) return std::nullopt;
  CameraRefinement open;
  open.estimates = std::move(*steps);
  Eigen::VectorXd values(static_cast<Eigen::Index>(open.estimates.size()));
  for (Eigen::Index i = 0; i < values.size(); ++i)
    values[i] = open.estimates[static_cast<std::size_t>(i)].value;
  open.covariance = fit.covariance() + values * values.transpose();
  return open;
}

}  // namespace apriltrack
