// Two tags of one id, seen by turns.

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "hypotheses/tag_hypotheses.h"
#include "numerics/upper_median.h"

namespace apriltrack {
namespace {

constexpr double kApart_m = 0.6, kTurned_rad = 0.9, kShareCopied = 0.02;  // one standard deviation
constexpr double kFarAside = 3.0;                                         // median distances from the middle
constexpr double kMostSizes = 20.0;           // a number counts for no more of its median
constexpr double kNoView_m2 = 1e-3;           // information of what a view does not tell, whitened
constexpr std::size_t kLeastViewsOfCopy = 2;  // of either copy

double median_size(const Eigen::VectorXd& values) {
  std::vector<double> sizes;
  for (const double value : values) sizes.push_back(std::abs(value));
  return std::max(upper_median(std::move(sizes)), 1e-9);
}

/// Where each view by itself wants the tag, from where it is: six numbers a row, each over its median size.
Eigen::MatrixXd wanted_places(const TagViews& tag) {
  Eigen::MatrixXd wanted(static_cast<Eigen::Index>(tag.views.size()), 6);
  for (std::size_t i = 0; i < tag.views.size(); ++i) {
    const LinearView& view = tag.map.views[tag.views[i]];
    const double weight = tag.map.root_weights[tag.views[i]] * tag.map.root_weights[tag.views[i]];
    const Matrix6d normal =
        view.by_tag.transpose() * view.by_tag / weight + kNoView_m2 * Matrix6d::Identity();
    const Vector6d right = view.by_tag.transpose() * view.residual / weight;
    wanted.row(static_cast<Eigen::Index>(i)) = -normal.ldlt().solve(right).transpose();
  }
  for (Eigen::Index k = 0; k < 6; ++k)
    wanted.col(k) = (wanted.col(k) / median_size(wanted.col(k))).cwiseMax(-kMostSizes).cwiseMin(kMostSizes);
  return wanted;
}

/// Those that want it far aside, all in one sense, along the line on which the views differ most.
std::vector<bool> far_views(const TagViews& tag) {
  const Eigen::MatrixXd wanted = wanted_places(tag);
  const Eigen::MatrixXd centred = wanted.rowwise() - wanted.colwise().mean();
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(Matrix6d(centred.transpose() * centred));
  Eigen::VectorXd along = wanted * eigen.eigenvectors().col(5);
  along.array() -= upper_median({along.begin(), along.end()});
  const double far = kFarAside * median_size(along);
  if ((along.array() < -far).count() > (along.array() > far).count()) along = -along;
  std::vector<bool> is_far;
  for (const double value : along) is_far.push_back(value > far);
  return is_far;
}

/// Of some views of all: that it is these which show the other copy is not known before.
double log_num_choices(std::size_t all, std::size_t some) {
  const auto log_factorial = [](std::size_t n) { return std::lgamma(static_cast<double>(n) + 1.0); };
  return log_factorial(all) - log_factorial(some) - log_factorial(all - some);
}

}  // namespace

std::vector<TagHypothesis> faults_of_identity(const TagViews& tag) {
  const std::vector<bool> is_far = far_views(tag);
  const auto far = static_cast<std::size_t>(std::ranges::count(is_far, true)), near = is_far.size() - far;
  if (std::min(far, near) < kLeastViewsOfCopy) return {};
  std::vector<ParameterView> columns;
  for (std::size_t i = 0; i < is_far.size(); ++i)
    if (is_far[i]) columns.push_back({tag.views[i], tag.map.views[tag.views[i]].by_tag});
  Vector6d sigma;
  sigma << Eigen::Vector3d::Constant(kApart_m), Eigen::Vector3d::Constant(kTurned_rad);
  const double log_prior = std::log(kShareCopied) - log_num_choices(is_far.size(), far);
  return {{.kind = TagFinding::Kind::kTwoPlaces,
           .evidence = evidence_of(tag.score(columns), tag.scale, sigma, log_prior),
           .is_at_second = is_far}};
}

}  // namespace apriltrack
