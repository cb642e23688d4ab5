#pragma once

#include <vector>

#include "apriltrack/calib/joint_covariance.h"
#include "uncertainty/joint_change.h"
#include "uncertainty/tag_covariance.h"

namespace apriltrack {

/// The whole matrix of which tag_covariances() gives the blocks of each tag, in units of the residuals as
/// `scale` has them. tags: numbers as `poses` has them; keys: their names, in the same order.
JointCovariance joint_tag_covariance(const PoseInformation& poses, const std::vector<int>& tags,
                                     std::vector<TagKey> keys, const ErrorScale& scale,
                                     const std::optional<SharedErrors>& shared = std::nullopt);

/// Rows of the system of `poses` to those of `tags`, zero for the held one.
Eigen::MatrixXd spread_rows(const PoseInformation& poses, const std::vector<int>& tags,
                            const Eigen::MatrixXd& rows);

/// What constraints know taken off, and the errors of a measured frame added. All that is left is then told
/// as noise.
void keep_to(const JointChange& change, JointCovariance& joint);

}  // namespace apriltrack
