#include "hypotheses/evidence.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace apriltrack {

namespace {

constexpr double kUndetermined = 1e-10;  // of the largest variance: a direction that no view shows

/// Of a gradient of such covariance: into independent numbers of unit variance, and 0 along directions that
/// no view shows.
Eigen::MatrixXd whitening_of(const Eigen::MatrixXd& covariance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(covariance);
  const double least = std::max(kUndetermined * eigen.eigenvalues().maxCoeff(), 1e-300);
  const Eigen::VectorXd inverse_root = (eigen.eigenvalues().array() > least)
                                           .select(eigen.eigenvalues().array().max(1e-300).rsqrt(), 0.0)
                                           .matrix();
  return inverse_root.asDiagonal() * eigen.eigenvectors().transpose();
}

double num_told(const Eigen::MatrixXd& whitening) {
  return static_cast<double>((whitening.rowwise().squaredNorm().array() > 0.0).count());
}

/// Of Gauss and Hermite: the mean of a polynomial of a standard normal number, up to the 13th degree.
constexpr std::pair<double, double> kNodes[] = {{0.0, 0.457142857},          {1.154405395, 0.240123179},
                                                {-1.154405395, 0.240123179}, {2.366759411, 0.030757124},
                                                {-2.366759411, 0.030757124}, {3.750439718, 0.000548269},
                                                {-3.750439718, 0.000548269}};

}  // namespace

double log_sum_exp(const std::vector<double>& values) {
  const double most = std::ranges::max(values);
  double sum = 0.0;
  for (const double value : values) sum += std::exp(value - most);
  return most + std::log(sum);
}

Score::Score(const ParameterInformation& parameters)
    : gradient(parameters.gradient), information(parameters.information) {
  by_kept_errors = Eigen::MatrixXd::Zero(gradient.size(), gradient.size());
  for (const auto& [tag, by_errors] : parameters.gradient_by_errors)
    by_kept_errors += by_errors * by_errors.transpose();
}

Score Score::combined(const Eigen::MatrixXd& by) const {
  Score result;
  result.gradient = by.transpose() * gradient;
  result.information = by.transpose() * information * by;
  result.by_kept_errors = by.transpose() * by_kept_errors * by;
  return result;
}

double Score::mean_square(const ErrorScale& scale) const {
  const Eigen::MatrixXd whitening = whitening_of(covariance(scale));
  return (whitening * gradient).squaredNorm() / std::max(1.0, num_told(whitening));
}

Evidence evidence_of(const Score& score, const NullScale& scale, const Eigen::VectorXd& prior_sigma,
                     double log_prior_odds) {
  const Eigen::MatrixXd whitening = whitening_of(score.covariance(scale.of_most));
  // gradient = -by_unit unit + noise of unit variance times the tag's factor, the parameters being
  // prior_sigma times `unit`.
  const Eigen::VectorXd gradient = whitening * score.gradient;
  const Eigen::MatrixXd by_unit = whitening * score.information * prior_sigma.asDiagonal();
  const Eigen::VectorXd right = by_unit.transpose() * gradient;
  const Eigen::MatrixXd information = by_unit.transpose() * by_unit;
  const Eigen::Index num = prior_sigma.size();
  const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(num, num);
  Evidence evidence;
  double likeliest = -std::numeric_limits<double>::infinity();
  std::vector<double> log_without, log_with;
  for (const auto& [place, weight] : kNodes) {
    if (scale.spread == 0.0 && place != 0.0) continue;
    const double factor = std::exp(scale.spread * place);
    const Eigen::LLT<Eigen::MatrixXd> precision(one + information / factor);
    const Eigen::VectorXd unit = -precision.solve(right) / factor;
    log_without.push_back(std::log(weight) - 0.5 * num_told(whitening) * std::log(factor) -
                          0.5 * gradient.squaredNorm() / factor);
    log_with.push_back(log_without.back() - 0.5 * right.dot(unit) / factor -
                       precision.matrixLLT().diagonal().array().log().sum());
    if (log_with.back() <= likeliest) continue;
    likeliest = log_with.back();
    evidence.value = prior_sigma.asDiagonal() * unit;
    evidence.covariance = prior_sigma.asDiagonal() * precision.solve(one) * prior_sigma.asDiagonal();
  }
  evidence.log_odds = log_sum_exp(log_with) - log_sum_exp(log_without) + log_prior_odds;
  return evidence;
}

}  // namespace apriltrack
