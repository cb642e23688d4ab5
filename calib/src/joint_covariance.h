#pragma once

#include <map>
#include <optional>

#include "tag_covariance.h"

namespace apriltrack {

/// What shared parameters that were estimated add: the poses follow their errors.
struct SharedErrors {
  explicit SharedErrors(const SharedParameters& shared);

  Eigen::MatrixXd poses_by_parameter;
  Eigen::MatrixXd covariance;
  std::map<int, Eigen::MatrixXd> parameters_by_errors;  ///< By the errors that each tag keeps.
};

/// The covariance of all poses together, rows as PoseInformation::offset_of() says (equations 7 and 10), as
/// an operator: no matrix of its size is made beyond the factor that is there.
class JointCovariance {
 public:
  /// Keeps references to `poses`.
  JointCovariance(const PoseInformation& poses, const ErrorScale& scale,
                  const std::optional<SharedParameters>& shared = std::nullopt);

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
