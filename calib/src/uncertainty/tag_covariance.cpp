#include "uncertainty/tag_covariance.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <map>
#include <utility>

namespace apriltrack {
namespace {

Matrix6d symmetric(const Matrix6d& matrix) {
  return 0.5 * (matrix + matrix.transpose());
}

/// rows: those of the inverse that belong to the tags from offset `first` on.
std::vector<TagCovariance> covariances_from(const PoseInformation& poses, const Eigen::MatrixXd& rows,
                                            Eigen::Index first, const std::optional<SharedErrors>& shared) {
  std::vector<TagCovariance> covariances(static_cast<std::size_t>(rows.rows() / 6));
  Eigen::MatrixXd d_poses_d_error(rows.rows(), 8);
  for (const auto& [tag, errors] : poses.by_errors()) {
    d_poses_d_error.setZero();
    for (const auto& [column, block] : errors) d_poses_d_error -= rows.middleCols<6>(column) * block;
    if (shared && shared->parameters_by_errors.contains(tag))
      d_poses_d_error +=
          shared->poses_by_parameter.middleRows(first, rows.rows()) * shared->parameters_by_errors.at(tag);
    for (std::size_t i = 0; i < covariances.size(); ++i) {
      const PoseInformation::Matrix6x8d own = d_poses_d_error.middleRows<6>(6 * static_cast<Eigen::Index>(i));
      covariances[i].by_bias += own * own.transpose();
    }
  }
  for (std::size_t i = 0; i < covariances.size(); ++i) {
    const Eigen::Index row = 6 * static_cast<Eigen::Index>(i);
    Matrix6d by_noise = rows.block<6, 6>(row, first + row);
    if (shared) {
      const Eigen::MatrixXd by_parameter = shared->poses_by_parameter.middleRows<6>(first + row);
      by_noise += by_parameter * shared->covariance * by_parameter.transpose();
    }
    covariances[i].by_noise = symmetric(by_noise);
    covariances[i].by_bias = symmetric(covariances[i].by_bias);
  }
  return covariances;
}

}  // namespace

SharedErrors::SharedErrors(const SharedParameters& shared)
    : poses_by_parameter(shared.information.poses_by_parameter) {
  // A prior weighs the more, the less the views know.
  const Eigen::MatrixXd prior = (shared.noise_factor * shared.prior_precision).asDiagonal();
  const Eigen::MatrixXd gain = (shared.information.information + prior)
                                   .ldlt()
                                   .solve(Eigen::MatrixXd::Identity(prior.rows(), prior.cols()));
  covariance = shared.noise_factor * gain;
  for (const auto& [tag, gradient] : shared.information.gradient_by_errors)
    parameters_by_errors[tag] = -gain * gradient;
}

SharedErrors::SharedErrors(const ParameterInformation& information, double variance)
    : poses_by_parameter(information.poses_by_parameter),
      covariance(variance * Eigen::MatrixXd::Identity(poses_by_parameter.cols(), poses_by_parameter.cols())) {
}

SharedErrors together(const SharedErrors& a, const SharedErrors& b) {
  const Eigen::Index of_a = a.covariance.rows(), of_b = b.covariance.rows();
  SharedErrors both = a;
  both.poses_by_parameter.resize(a.poses_by_parameter.rows(), of_a + of_b);
  both.poses_by_parameter << a.poses_by_parameter, b.poses_by_parameter;
  both.covariance = Eigen::MatrixXd::Zero(of_a + of_b, of_a + of_b);
  both.covariance.topLeftCorner(of_a, of_a) = a.covariance;
  both.covariance.bottomRightCorner(of_b, of_b) = b.covariance;
  both.parameters_by_errors.clear();
  const auto add = [&](const SharedErrors& one, Eigen::Index first) {
    for (const auto& [tag, errors] : one.parameters_by_errors) {
      Eigen::MatrixXd& all =
          both.parameters_by_errors.try_emplace(tag, Eigen::MatrixXd::Zero(of_a + of_b, errors.cols()))
              .first->second;
      all.middleRows(first, errors.rows()) = errors;
    }
  };
  add(a, 0);
  add(b, of_a);
  return both;
}

std::vector<TagCovariance> tag_covariances(const PoseInformation& poses, const std::vector<int>& tags,
                                           const std::optional<SharedErrors>& shared) {
  constexpr Eigen::Index kTagsAtOnce = 16;  // of the inverse: few enough to be small, enough to be fast
  std::map<Eigen::Index, TagCovariance> by_offset;
  for (Eigen::Index first = 0; first < poses.size(); first += 6 * kTagsAtOnce) {
    const Eigen::Index width = std::min(6 * kTagsAtOnce, poses.size() - first);
    Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(poses.size(), width);
    columns.middleRows(first, width).setIdentity();
    const Eigen::MatrixXd rows = poses.solve(std::move(columns)).transpose();  // the inverse is symmetric
    Eigen::Index offset = first;
    for (TagCovariance& covariance : covariances_from(poses, rows, first, shared)) {
      by_offset[offset] = std::move(covariance);
      offset += 6;
    }
  }
  std::vector<TagCovariance> covariances;
  for (const int tag : tags) {
    const auto offset = poses.offset_of(tag);
    covariances.push_back(offset ? by_offset.at(*offset) : TagCovariance{});
  }
  return covariances;
}

void scale_by(const ErrorScale& scale, std::vector<TagCovariance>& covariances) {
  for (TagCovariance& tag : covariances) {
    tag.by_noise *= scale.noise_variance;
    tag.by_bias *= scale.bias_variance;
  }
}

}  // namespace apriltrack
