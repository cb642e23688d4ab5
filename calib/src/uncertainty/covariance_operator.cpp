#include "uncertainty/covariance_operator.h"

#include <utility>

namespace apriltrack {

CovarianceOperator::CovarianceOperator(const PoseInformation& poses, const ErrorScale& scale,
                                       const std::optional<SharedErrors>& shared)
    : poses_(poses), scale_(scale), shared_(shared) {}

Eigen::MatrixXd CovarianceOperator::times(const Eigen::MatrixXd& columns) const {
  const Eigen::MatrixXd solved = poses_.solve(columns);
  Eigen::MatrixXd result = scale_.noise_variance * solved;
  Eigen::MatrixXd by_parameter;  // of the columns
  if (shared_) {
    by_parameter = shared_->poses_by_parameter.transpose() * columns;
    result += scale_.noise_variance * (shared_->poses_by_parameter * (shared_->covariance * by_parameter));
  }
  if (scale_.bias_variance == 0.0) return result;
  // sum over tags k of D_k D_k' columns, D_k = -S^-1 G_k + (poses by parameter) (parameters by errors).
  Eigen::MatrixXd by_errors = Eigen::MatrixXd::Zero(size(), columns.cols());  // sum G_k D_k' columns
  Eigen::MatrixXd parameters;
  if (shared_) parameters = Eigen::MatrixXd::Zero(by_parameter.rows(), columns.cols());
  for (const auto& [tag, blocks] : poses_.by_errors()) {
    Eigen::MatrixXd projected = Eigen::MatrixXd::Zero(8, columns.cols());  // D_k' columns
    for (const auto& [offset, block] : blocks) projected -= block.transpose() * solved.middleRows<6>(offset);
    const bool has_shared = shared_ && shared_->parameters_by_errors.contains(tag);
    if (has_shared) projected += shared_->parameters_by_errors.at(tag).transpose() * by_parameter;
    for (const auto& [offset, block] : blocks) by_errors.middleRows<6>(offset) += block * projected;
    if (has_shared) parameters += shared_->parameters_by_errors.at(tag) * projected;
  }
  result -= scale_.bias_variance * poses_.solve(std::move(by_errors));
  if (shared_) result += scale_.bias_variance * (shared_->poses_by_parameter * parameters);
  return result;
}

}  // namespace apriltrack
