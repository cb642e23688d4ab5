#pragma once

#include <Eigen/Core>
#include <vector>

#include "uncertainty/error_scale.h"
#include "uncertainty/pose_information.h"

namespace apriltrack {

/// Of the values' exponentials. Not empty.
double log_sum_exp(const std::vector<double>& values);

/// What linearised views say of some parameters that are 0 unless a hypothesis is true.
struct Evidence {
  double log_odds = 0.0;  ///< Posterior, of the hypothesis against none, nats.
  Eigen::VectorXd value;  ///< Posterior mean.
  Eigen::MatrixXd covariance;
};

/// Of parameters, poses eliminated: what Rao's score test needs (C. R. Rao, "Large sample tests of
/// statistical hypotheses concerning several parameters", 1948).
struct Score {
  Eigen::VectorXd gradient;
  Eigen::MatrixXd information;
  Eigen::MatrixXd by_kept_errors;  ///< Covariance of the gradient by errors of unit variance that tags keep.

  explicit Score(const ParameterInformation& parameters);
  /// Of parameters that are `by` times fewer ones.
  Score combined(const Eigen::MatrixXd& by) const;

  Eigen::MatrixXd covariance(const ErrorScale& scale) const {
    return scale.noise_variance * information + scale.bias_variance * by_kept_errors;
  }
  /// Squared length of the gradient in sigmas: chi-squared, of as many degrees of freedom as there are
  /// parameters that the views tell of, where these are 0. Over that number.
  double mean_square(const ErrorScale& scale) const;

 private:
  Score() = default;
};

/// How large the errors are behind a tag's score where nothing is wrong with the tag.
struct NullScale {
  ErrorScale of_most;    ///< Of half of the tags.
  double spread = 0.0;   ///< Standard deviation of the logarithm of a tag's own variances, over those.
  double lasting = 1.0;  ///< Of what lasts from a moment on, over what differs between stretches of time.

  NullScale times(double factor) const {
    return {{of_most.noise_variance * factor, of_most.bias_variance * factor}, spread, lasting};
  }
};

/// The score test with a prior: the gradient is normal, of covariance S where the parameters are 0, and of
/// S + C P C where they are drawn from a normal prior of covariance P = diag(prior_sigma^2), C their
/// information. S is the scale's, times the tag's own factor, over which both densities are integrated.
/// log_odds is the logarithm of their ratio plus log_prior_odds.
Evidence evidence_of(const Score& score, const NullScale& scale, const Eigen::VectorXd& prior_sigma,
                     double log_prior_odds);

}  // namespace apriltrack
