#pragma once

#include <optional>

#include "uncertainty/tag_covariance.h"

namespace apriltrack {

/// The covariance of all poses together, rows as PoseInformation::offset_of() says (equations 7 and 10), as
/// an operator: no matrix of its size is made beyond the factor that is there.
class CovarianceOperator {
 public:
  /// Keeps references to `poses`.
  CovarianceOperator(const PoseInformation& poses, const ErrorScale& scale,
                     const std::optional<SharedErrors>& shared = std::nullopt);

  std::optional<Eigen::Index> offset_of(int tag) const { return poses_.offset_of(tag); }
  Eigen::Index size() const { return poses_.size(); }
  /// The covariance times `columns`.
  Eigen::MatrixXd times(const Eigen::MatrixXd& columns) const;

 private:
  const PoseInformation& poses_;
  ErrorScale scale_;
  std::optional<SharedErrors> shared_;
};

}  // namespace apriltrack
