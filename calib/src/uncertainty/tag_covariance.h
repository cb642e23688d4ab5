#pragma once

#include <map>
#include <optional>
#include <vector>

#include "uncertainty/error_scale.h"
#include "uncertainty/pose_information.h"

namespace apriltrack {

/// Of a tag's pose (right perturbation, [translation; rotation]), relative to the held tag; all zero for that
/// one itself.
struct TagCovariance {
  /// By residuals that are independent and, once whitened, of unit variance.
  Matrix6d by_noise = Matrix6d::Zero();
  /// By errors that every tag, the held one too, keeps in all of its views: eight numbers per tag, whitened,
  /// independent and of unit variance (S. F. Schmidt's "consider" parameters).
  Matrix6d by_bias = Matrix6d::Zero();
};

/// Parameters beside the poses (a lens) that were estimated with them.
struct SharedParameters {
  ParameterInformation information;
  Eigen::VectorXd prior_precision;  ///< What was known of them before, in the units of the residuals.
  double noise_factor = 1.0;  ///< How much more of the noise they follow than poses do (block_scatter.h).
};

/// What they add: the poses follow their errors.
struct SharedErrors {
  explicit SharedErrors(const SharedParameters& shared);
  /// Of parameters that were estimated elsewhere, in units in which their errors are independent and of
  /// variance `variance` (of the noise that the views have).
  SharedErrors(const ParameterInformation& information, double variance);

  Eigen::MatrixXd poses_by_parameter;
  Eigen::MatrixXd covariance;
  std::map<int, Eigen::MatrixXd> parameters_by_errors;
};

/// Of parameters that were estimated independently of each other.
SharedErrors together(const SharedErrors& a, const SharedErrors& b);

/// In the order of `tags`: what ceres::Covariance gives, at a cost that a thousand frames do not raise. Only
/// the system of the tags is inverted, a few columns at a time.
std::vector<TagCovariance> tag_covariances(const PoseInformation& poses, const std::vector<int>& tags,
                                           const std::optional<SharedErrors>& shared = std::nullopt);

/// Of unit errors, to those of the residuals.
void scale_by(const ErrorScale& scale, std::vector<TagCovariance>& covariances);

}  // namespace apriltrack
