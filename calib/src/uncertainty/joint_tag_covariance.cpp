#include "uncertainty/joint_tag_covariance.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

namespace apriltrack {

Eigen::MatrixXd spread_rows(const PoseInformation& poses, const std::vector<int>& tags,
                            const Eigen::MatrixXd& rows) {
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(6 * static_cast<Eigen::Index>(tags.size()), rows.cols());
  for (std::size_t i = 0; i < tags.size(); ++i) {
    if (const auto offset = poses.offset_of(tags[i]))
      result.middleRows<6>(6 * static_cast<Eigen::Index>(i)) = rows.middleRows<6>(*offset);
  }
  return result;
}

namespace {

/// Columns of the inverse of the normal equations, six for each of `tags`: zero for the held one.
Eigen::MatrixXd noise_columns(const PoseInformation& poses, std::span<const int> tags,
                              const std::optional<SharedErrors>& follow) {
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(poses.size(), 6 * static_cast<Eigen::Index>(tags.size()));
  Eigen::MatrixXd by_parameter;  // of the columns
  if (follow) by_parameter = Eigen::MatrixXd::Zero(follow->poses_by_parameter.cols(), columns.cols());
  for (std::size_t i = 0; i < tags.size(); ++i) {
    const auto offset = poses.offset_of(tags[i]);
    if (!offset) continue;
    const Eigen::Index column = 6 * static_cast<Eigen::Index>(i);
    columns.block<6, 6>(*offset, column).setIdentity();
    if (follow)
      by_parameter.middleCols<6>(column) = follow->poses_by_parameter.middleRows<6>(*offset).transpose();
  }
  columns = poses.solve(std::move(columns));
  if (follow) columns += follow->poses_by_parameter * (follow->covariance * by_parameter);
  return columns;
}

/// In place.
void make_symmetric(Eigen::MatrixXd& matrix) {
  for (Eigen::Index column = 0; column < matrix.cols(); ++column) {
    for (Eigen::Index row = 0; row < column; ++row) {
      matrix(row, column) = 0.5 * (matrix(row, column) + matrix(column, row));
      matrix(column, row) = matrix(row, column);
    }
  }
}

}  // namespace

JointCovariance joint_tag_covariance(const PoseInformation& poses, const std::vector<int>& tags,
                                     std::vector<TagKey> keys, const ErrorScale& scale,
                                     const std::optional<SharedErrors>& follow) {
  JointCovariance joint;
  joint.tags = std::move(keys);
  joint.noise_variance = scale.noise_variance / scale.views_per_independent_view;
  joint.bias_sigma = std::sqrt(scale.bias_variance);

  const Eigen::Index size = 6 * static_cast<Eigen::Index>(tags.size());
  joint.by_noise = Eigen::MatrixXd::Zero(size, size);
  constexpr std::size_t kTagsAtOnce = 16;  // a large map's matrix is in memory once
  for (std::size_t first = 0; first < tags.size(); first += kTagsAtOnce) {
    const std::span<const int> some =
        std::span(tags).subspan(first, std::min(kTagsAtOnce, tags.size() - first));
    const Eigen::MatrixXd columns = noise_columns(poses, some, follow);
    joint.by_noise.middleCols(6 * static_cast<Eigen::Index>(first), columns.cols()) =
        scale.noise_variance * spread_rows(poses, tags, columns);
  }
  make_symmetric(joint.by_noise);

  joint.by_errors = Eigen::MatrixXd::Zero(size, 8 * static_cast<Eigen::Index>(tags.size()));
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
