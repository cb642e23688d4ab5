#include "solve/camera_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "model/corner_views.h"
#include "solve/bundle_adjustment.h"
#include "uncertainty/block_scatter.h"

namespace apriltrack {
namespace {

constexpr int kMaxSteps = 8;
constexpr double kSettled = 0.02;  // of a standard deviation
// Of a direction of the parameters, over what the prior knows of it: below it the views tell nothing. And
// over what is known of the best: below it rounding tells as much.
constexpr double kLeastInformation = 1e-6, kLeastOfLargest = 1e-13;

}  // namespace

bool CameraFit::run(MapState& state) {
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

std::optional<std::vector<EstimatedParameter>> CameraFit::look(const MapState& state) {
  total_ = already_moved(state);
  step_number_ = 0;
  const auto step = step_of_cameras(state);
  if (!step) return std::nullopt;
  total_ = *step;
  return estimates();
}

std::vector<EstimatedParameter> CameraFit::estimates() const {
  std::vector<EstimatedParameter> result;
  for (std::size_t i = 0; i < parameters_.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    result.push_back({parameters_[i], total_[k] * parameters_[i].sigma, sigmas_[k] * parameters_[i].sigma});
  }
  return result;
}

Eigen::MatrixXd CameraFit::covariance() const {
  Eigen::VectorXd units(covariance_.rows());
  for (Eigen::Index i = 0; i < units.size(); ++i) units[i] = parameters_[static_cast<std::size_t>(i)].sigma;
  return units.asDiagonal() * covariance_ * units.asDiagonal();
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

/// In units of the parameters' sigmas.
std::optional<Eigen::VectorXd> CameraFit::step_of_cameras(const MapState& state) {
  const std::vector<LinearView> views = corner_views(task_.observations, part_.views, state);
  const auto poses = PoseInformation::of(views, part_.tags, held_tag_);
  if (!poses || views.size() != part_.views.size()) return std::nullopt;
  const std::vector<ParameterView> columns =
      camera_columns(task_.observations, part_.views, state, parameters_);
  const ParameterInformation of_cameras = poses->eliminate_poses(columns);
  if (step_number_++ < 2) {  // then it stays, or prior and views would pull to and fro
    scale_ = error_scale(views, *poses, expected_bias_variance(task_.options));
    noise_variance_ =
        scale_.noise_variance *
        BlockScatter(views, *poses).parameters_factor(columns, of_cameras, scale_.noise_variance);
  }
  const Eigen::Index num = total_.size();
  // Errors that tags keep weigh as if they were so much more noise.
  const Eigen::MatrixXd spread = gradient_covariance(
      of_cameras, {.noise_variance = noise_variance_, .bias_variance = scale_.bias_variance});
  // By the views alone, along the directions that they tell of; of the others the prior is all that is known.
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> of_views(of_cameras.information);
  const Eigen::VectorXd& information = of_views.eigenvalues();  // in ascending order
  const double least = std::max(kLeastInformation, kLeastOfLargest * information[num - 1]);
  const Eigen::Index num_told = (information.array() > least).count();
  const Eigen::MatrixXd told = of_views.eigenvectors().rightCols(num_told);
  const Eigen::VectorXd inverse = information.tail(num_told).cwiseInverse();
  const Eigen::VectorXd estimate =
      told.transpose() * total_ - inverse.cwiseProduct(told.transpose() * of_cameras.gradient);
  const Eigen::MatrixXd covariance =
      inverse.asDiagonal() * (told.transpose() * spread * told) * inverse.asDiagonal();
  // With what was known before: mean 0, variance 1.
  const Eigen::MatrixXd both =
      (covariance + Eigen::MatrixXd::Identity(num_told, num_told)).ldlt().solve(told.transpose());
  const Eigen::VectorXd target = both.transpose() * estimate;  // prior (prior + covariance)^-1 estimate
  covariance_ = Eigen::MatrixXd::Identity(num, num) - told * both;
  sigmas_ = covariance_.diagonal().cwiseMax(1e-16).cwiseSqrt();
  if (!target.allFinite()) return std::nullopt;
  return target - total_;
}

bool CameraFit::move(const Eigen::VectorXd& step, MapState& state) {
  for (std::size_t i = 0; i < parameters_.size(); ++i) {
    RigCamera& camera = state.cameras[static_cast<std::size_t>(parameters_[i].camera)];
    const auto next =
        moved(camera, parameters_[i], step[static_cast<Eigen::Index>(i)] * parameters_[i].sigma);
    if (!next) return false;
    camera = *next;
  }
  total_ = already_moved(state);  // shares of a focal length multiply
  return true;
}

}  // namespace apriltrack
