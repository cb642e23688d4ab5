#include "solve/camera_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "model/corner_views.h"
#include "solve/bundle_adjustment.h"
#include "solve/reduced_equations.h"
#include "uncertainty/block_scatter.h"

namespace apriltrack {
namespace {

constexpr int kMaxSteps = 8;
constexpr double kSettled = 0.02;  // of a standard deviation
// Of the squares, by a step that goes too far: the prior's pull makes them rise by less.
constexpr double kMostRise = 1.001;
// Of a direction of the parameters, over what the prior knows of it: below it the views tell nothing. And
// over what is known of the best: below it rounding tells as much.
constexpr double kLeastInformation = 1e-6, kLeastOfLargest = 1e-13;

ParameterInformation of_some(const ParameterInformation& all, const std::vector<Eigen::Index>& some) {
  ParameterInformation result{
      all.information(some, some), all.gradient(some), all.poses_by_parameter(Eigen::all, some), {}};
  for (const auto& [tag, gradient] : all.gradient_by_errors)
    result.gradient_by_errors[tag] = gradient(some, Eigen::all);
  return result;
}

std::vector<ParameterView> of_some(const std::vector<ParameterView>& all,
                                   const std::vector<Eigen::Index>& some) {
  std::vector<ParameterView> result;
  result.reserve(all.size());
  for (const ParameterView& one : all) result.push_back({one.view, one.by_parameter(Eigen::all, some)});
  return result;
}

}  // namespace

CameraFit::CameraFit(const PartTask& task, CameraParameters parameters, Part part, int held_tag,
                     MapState start)
    : task_(task),
      parameters_(std::move(parameters)),
      part_(std::move(part)),
      held_tag_(held_tag),
      state_(std::move(start)) {
  const std::map<int, int> num_views = count_views(task.observations, part_);
  most_seen_tag_ = std::ranges::max_element(num_views, {}, [](const auto& tag) { return tag.second; })->first;
  linearise();
}

void CameraFit::linearise() {
  total_ = already_moved(state_);
  poses_.reset();
  views_ = corner_views(task_.observations, part_.views, state_);
  if (views_.size() != part_.views.size()) return;
  poses_ = PoseInformation::of(views_, part_.tags, most_seen_tag_);
  if (!poses_) return;
  columns_ = camera_columns(task_.observations, part_.views, state_, parameters_);
  of_cameras_ = poses_->eliminate_poses(columns_);
  if (num_scaled_++ >= 2) return;  // then it stays, or prior and views would pull to and fro
  scale_ = error_scale(views_, *poses_, expected_bias_variance(task_.options));
  noise_variance_ = noise_variance(columns_, of_cameras_);
}

double CameraFit::squares() const {
  double squares = 0.0;
  for (const LinearView& view : views_) squares += view.residual.squaredNorm();
  return squares;
}

double CameraFit::promised_gain() const {
  if (!poses_) return 0.0;
  const auto num = total_.size();
  const Eigen::VectorXd step =
      (of_cameras_.information + Eigen::MatrixXd::Identity(num, num)).ldlt().solve(of_cameras_.gradient);
  return 1.0 - std::sqrt(std::max(0.0, 1.0 - of_cameras_.gradient.dot(step) / std::max(squares(), 1e-12)));
}

std::optional<CameraEstimates> CameraFit::look(const IsAsked& is_asked) const {
  if (!poses_) return std::nullopt;
  CameraParameters asked;
  std::vector<Eigen::Index> index;
  for (std::size_t i = 0; i < parameters_.size(); ++i) {
    if (!is_asked(parameters_[i])) continue;
    asked.push_back(parameters_[i]);
    index.push_back(static_cast<Eigen::Index>(i));
  }
  if (asked.empty()) return std::nullopt;
  const ParameterInformation of_asked = of_some(of_cameras_, index);
  auto found = posterior(of_asked, total_(index), noise_variance(of_some(columns_, index), of_asked));
  if (!found) return std::nullopt;
  found->mean -= total_(index);
  return in_units(*found, asked);
}

bool CameraFit::run() {
  for (int i = 0; i < kMaxSteps; ++i) {
    if (task_.options.should_stop && task_.options.should_stop()) throw Stopped();
    if (!poses_) return false;
    const auto found = posterior(of_cameras_, total_, noise_variance_);
    if (!found) return false;
    const Eigen::VectorXd step = found->mean - total_;
    covariance_ = found->covariance;
    const double squares_before = squares();
    for (std::size_t v = 0; v < views_.size(); ++v) views_[v].residual += columns_[v].by_parameter * step;
    const auto poses = solve_steps(views_, held_tag_);
    if (!poses || !move(step)) return false;
    take(*poses, state_);
    if (step.cwiseQuotient(found->sigmas()).cwiseAbs().maxCoeff() < kSettled) {
      total_ = already_moved(state_);
      return true;
    }
    linearise();
    if (squares() <= kMostRise * squares_before) continue;
    if (!settle_poses(task_, part_, held_tag_, state_)) return false;
    linearise();
  }
  return false;
}

CameraEstimates CameraFit::in_units(const Posterior& posterior, const CameraParameters& parameters) {
  CameraEstimates result;
  const Eigen::VectorXd sigmas = posterior.sigmas();
  Eigen::VectorXd units(sigmas.size());
  for (Eigen::Index i = 0; i < units.size(); ++i) {
    const CameraParameter& parameter = parameters[static_cast<std::size_t>(i)];
    units[i] = parameter.sigma;
    result.parameters.push_back({parameter, posterior.mean[i] * units[i], sigmas[i] * units[i]});
  }
  result.covariance = units.asDiagonal() * posterior.covariance * units.asDiagonal();
  return result;
}

double CameraFit::log_odds_of_change(const MapState& before) const {
  const Eigen::VectorXd moved_before = already_moved(before);
  std::vector<Eigen::Index> as_given;
  for (std::size_t i = 0; i < parameters_.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const bool is_in_file = parameters_[i].is_of_lens() || parameters_[i].is_of_place();
    if (is_in_file && moved_before[k] == 0.0) as_given.push_back(k);
  }
  if (as_given.empty()) return std::numeric_limits<double>::infinity();
  const Eigen::VectorXd estimate = total_(as_given);  // the prior: mean 0, covariance 1
  const Eigen::LLT<Eigen::MatrixXd> factor(covariance_(as_given, as_given));
  if (factor.info() != Eigen::Success) return -std::numeric_limits<double>::infinity();
  const double log_determinant = 2.0 * factor.matrixLLT().diagonal().array().log().sum();
  return 0.5 * (estimate.dot(factor.solve(estimate)) + log_determinant);
}

/// What was found before is part of what is estimated now.
Eigen::VectorXd CameraFit::already_moved(const MapState& state) const {
  Eigen::VectorXd total(static_cast<Eigen::Index>(parameters_.size()));
  for (std::size_t i = 0; i < parameters_.size(); ++i) {
    const auto camera = static_cast<std::size_t>(parameters_[i].camera);
    total[static_cast<Eigen::Index>(i)] =
        difference(task_.observations.cameras[camera], state.cameras[camera], parameters_[i]) /
        parameters_[i].sigma;
  }
  return total;
}

double CameraFit::noise_variance(const std::vector<ParameterView>& columns,
                                 const ParameterInformation& of_cameras) const {
  return scale_.noise_variance *
         BlockScatter(views_, *poses_).parameters_factor(columns, of_cameras, scale_.noise_variance);
}

std::optional<CameraFit::Posterior> CameraFit::posterior(const ParameterInformation& of_cameras,
                                                         const Eigen::VectorXd& moved,
                                                         double noise_variance) const {
  const Eigen::Index num = moved.size();
  // Errors that tags keep weigh as if they were so much more noise.
  const Eigen::MatrixXd spread = gradient_covariance(
      of_cameras, {.noise_variance = noise_variance, .bias_variance = scale_.bias_variance});
  // By the views alone, along the directions that they tell of; of the others the prior is all that is known.
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> of_views(of_cameras.information);
  const Eigen::VectorXd& information = of_views.eigenvalues();  // in ascending order
  const double least = std::max(kLeastInformation, kLeastOfLargest * information[num - 1]);
  const Eigen::Index num_told = (information.array() > least).count();
  const Eigen::MatrixXd told = of_views.eigenvectors().rightCols(num_told);
  const Eigen::VectorXd inverse = information.tail(num_told).cwiseInverse();
  const Eigen::VectorXd estimate =
      told.transpose() * moved - inverse.cwiseProduct(told.transpose() * of_cameras.gradient);
  const Eigen::MatrixXd covariance =
      inverse.asDiagonal() * (told.transpose() * spread * told) * inverse.asDiagonal();
  // With what was known before: mean 0, variance 1.
  const Eigen::MatrixXd both =
      (covariance + Eigen::MatrixXd::Identity(num_told, num_told)).ldlt().solve(told.transpose());
  // prior (prior + covariance)^-1 estimate
  Posterior result{both.transpose() * estimate, Eigen::MatrixXd::Identity(num, num) - told * both};
  if (!result.mean.allFinite()) return std::nullopt;
  return result;
}

bool CameraFit::move(const Eigen::VectorXd& step) {
  for (std::size_t i = 0; i < parameters_.size(); ++i) {
    RigCamera& camera = state_.cameras[static_cast<std::size_t>(parameters_[i].camera)];
    const auto next =
        moved(camera, parameters_[i], step[static_cast<Eigen::Index>(i)] * parameters_[i].sigma);
    if (!next) return false;
    camera = *next;
  }
  return true;
}

}  // namespace apriltrack
