#include "faults/moves_of_tag.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <utility>

namespace apriltrack {
namespace {

constexpr std::size_t kLeastViewsOfPlace = 3;  // at the first place, and at the last
constexpr std::size_t kMostMoments = 24;
constexpr double kLeastInformed = 1e-4;  // of what the tag's own views say; less is what rounding leaves

Eigen::Index first_row_of(std::size_t moment) {
  return 6 * static_cast<Eigen::Index>(moment);
}

}  // namespace

MovesOfTag::MovesOfTag(const LinearPart& part, int tag) : part_(&part) {
  none_.tag = tag;
  for (std::size_t i = 0; i < part.views.size(); ++i) {
    if (part.views[i].tag != tag) continue;
    views_.push_back(i);
    none_.views.push_back(part.part.views[i]);
  }
  choose_moments();
  if (moments_.empty()) return;
  from_moments_ = part.poses->eliminate_poses(columns());
  sum_from_each_moment_on();
  gradient_covariance_ = gradient_covariance(from_moments_, part.scale);
}

Move MovesOfTag::with_one_more(const Move& move) const {
  Move best = move;
  for (const std::size_t moment : moments_) {
    if (std::ranges::find(move.moments, moment) != move.moments.end()) continue;
    Move trial = move;
    trial.moments.push_back(moment);
    estimate(trial);
    if (trial.changes.allFinite() && trial.squares > best.squares) best = std::move(trial);
  }
  return best;
}

Move MovesOfTag::all() const {
  Move result = none_;
  result.moments = moments_;
  if (!moments_.empty()) estimate(result);
  return result;
}

void MovesOfTag::choose_moments() {
  if (views_.size() < 2 * kLeastViewsOfPlace) return;
  const std::size_t choices = views_.size() - 2 * kLeastViewsOfPlace + 1;
  const std::size_t tried = std::min(choices, kMostMoments);
  for (std::size_t i = 0; i < tried; ++i) moments_.push_back(kLeastViewsOfPlace + i * choices / tried);
}

std::vector<ParameterView> MovesOfTag::columns() const {
  std::vector<ParameterView> result;
  for (std::size_t m = 0; m < moments_.size(); ++m) {
    const std::size_t end = m + 1 < moments_.size() ? moments_[m + 1] : views_.size();
    for (std::size_t i = moments_[m]; i < end; ++i)
      result.push_back({views_[i], part_->views[views_[i]].by_tag, first_row_of(m)});
  }
  return result;
}

void MovesOfTag::sum_from_each_moment_on() {
  auto& [information, gradient, poses, by_errors] = from_moments_;
  own_ = Eigen::VectorXd::Zero(gradient.size());
  for (const ParameterView& column : columns())
    own_.segment<6>(column.first) += column.by_parameter.colwise().squaredNorm().transpose();
  for (Eigen::Index row = gradient.size() - 7; row >= 0; --row) {
    own_[row] += own_[row + 6];
    gradient[row] += gradient[row + 6];
    information.row(row) += information.row(row + 6);
    for (auto& [tag, block] : by_errors) block.row(row) += block.row(row + 6);
  }
  for (Eigen::Index column = gradient.size() - 7; column >= 0; --column)
    information.col(column) += information.col(column + 6);
}

std::vector<Eigen::Index> MovesOfTag::rows_of(const Move& move) const {
  std::vector<Eigen::Index> rows;
  for (const std::size_t moment : move.moments) {
    const auto at = std::ranges::lower_bound(moments_, moment);
    for (Eigen::Index i = 0; i < 6; ++i)
      rows.push_back(first_row_of(static_cast<std::size_t>(at - moments_.begin())) + i);
  }
  return rows;
}

void MovesOfTag::estimate(Move& move) const {
  const std::vector<Eigen::Index> rows = rows_of(move);
  const Eigen::VectorXd gradient = from_moments_.gradient(rows);
  Eigen::MatrixXd information = from_moments_.information(rows, rows);
  information.diagonal() += kLeastInformed * own_(rows);
  Eigen::MatrixXd covariance = gradient_covariance_(rows, rows);
  covariance.diagonal() += part_->scale.noise_variance * kLeastInformed * own_(rows);
  move.changes = -information.ldlt().solve(gradient);
  move.squares = gradient.dot(covariance.ldlt().solve(gradient));
}

}  // namespace apriltrack
