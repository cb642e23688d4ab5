#include "joint_tag_covariance.h"

#include <cmath>
#include <utility>

namespace apriltrack {
namespace {

/// Rows of the system of `poses` to those of `tags`, zero for the held one.
Eigen::MatrixXd spread_rows(const PoseInformation& poses, const std::vector<int>& tags,
                            const Eigen::MatrixXd& rows) {
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(6 * static_cast<Eigen::Index>(tags.size()), rows.cols());
  for (std::size_t i = 0; i < tags.size(); ++i) {
    if (const auto offset = poses.offset_of(tags[i]))
      result.middleRows<6>(6 * static_cast<Eigen::Index>(i)) = rows.middleRows<6>(*offset);
  }
  return result;
}

}  // namespace

JointCovariance joint_tag_covariance(const PoseInformation& poses, const std::vector<int>& tags,
                                     std::vector<TagKey> keys, const ErrorScale& scale,
                                     const std::optional<SharedParameters>& shared) {
  JointCovariance joint;
  joint.tags = std::move(keys);
  joint.noise_variance = scale.noise_variance / scale.views_per_independent_view;
  joint.bias_sigma = std::sqrt(scale.bias_variance);
  std::optional<SharedErrors> follow;
  if (shared) follow.emplace(*shared);

  Eigen::MatrixXd inverse = poses.solve(Eigen::MatrixXd::Identity(poses.size(), poses.size()));
  if (follow)
    inverse += follow->poses_by_parameter * follow->covariance * follow->poses_by_parameter.transpose();
  inverse = 0.5 * (inverse + inverse.transpose()).eval();
  const Eigen::MatrixXd rows = spread_rows(poses, tags, inverse);
  joint.by_noise = scale.noise_variance * spread_rows(poses, tags, rows.transpose());

  joint.by_errors = Eigen::MatrixXd::Zero(rows.rows(), 8 * static_cast<Eigen::Index>(tags.size()));
  for (std::size_t i = 0; i < tags.size(); ++i) {
    if (!poses.by_errors().contains(tags[i])) continue;
    Eigen::MatrixXd by_errors = poses.poses_by_errors(tags[i]);
    if (follow && follow->parameters_by_errors.contains(tags[i]))
      by_errors += follow->poses_by_parameter * follow->parameters_by_errors.at(tags[i]);
    joint.by_errors.middleCols<8>(8 * static_cast<Eigen::Index>(i)) =
        joint.bias_sigma * spread_rows(poses, tags, by_errors);
  }
  return joint;
}

void keep_to(const JointChange& change, JointCovariance& joint) {
  if (joint.is_empty() || change.lost_root.size() == 0) return;
  joint.by_noise = joint.matrix();
  change.apply(joint.by_noise);
  joint.by_errors = change.follow(joint.by_errors);
  joint.by_noise.noalias() -= joint.by_errors * joint.by_errors.transpose();
}

}  // namespace apriltrack
