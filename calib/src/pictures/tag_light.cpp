#include "pictures/tag_light.h"

#include <algorithm>

namespace apriltrack {
namespace {

constexpr int kNodesPerCell = 2;
/// Of the mean weight of a node: how stiffly it is tied to each of its neighbours.
constexpr double kStiffness = 0.1;
/// Of that: how stiffly to even light.
constexpr double kPullToEven = 0.01;
constexpr int kSweeps = 40;

}  // namespace

TagLight::TagLight(double half_extent, int num_cells)
    : half_extent_(half_extent),
      nodes_per_unit_(kNodesPerCell * num_cells / (2.0 * half_extent)),
      num_nodes_(kNodesPerCell * num_cells + 1),
      excess_(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(num_nodes_) * num_nodes_)) {}

TagLight::Corners TagLight::corners_about(double u, double v) const {
  const double x = (u + half_extent_) * nodes_per_unit_, y = (v + half_extent_) * nodes_per_unit_;
  const int column = std::clamp(static_cast<int>(x), 0, num_nodes_ - 2);
  const int row = std::clamp(static_cast<int>(y), 0, num_nodes_ - 2);
  const double right = std::clamp(x - column, 0.0, 1.0), down = std::clamp(y - row, 0.0, 1.0);
  return {
      static_cast<std::size_t>(row) * static_cast<std::size_t>(num_nodes_) + static_cast<std::size_t>(column),
      {(1.0 - right) * (1.0 - down), right * (1.0 - down), (1.0 - right) * down, right * down}};
}

double TagLight::factor(double u, double v) const {
  const Corners corners = corners_about(u, v);
  const double* first = excess_.data() + corners.first;
  const Eigen::Vector4d nodes(first[0], first[1], first[num_nodes_], first[num_nodes_ + 1]);
  return 1.0 + corners.shares.dot(nodes);
}

void TagLight::Sums::add(const TagLight& light, double u, double v, double white, double residual,
                         double weight) {
  const Corners corners = light.corners_about(u, v);
  const auto below = static_cast<std::size_t>(light.num_nodes_);
  const std::size_t nodes[] = {corners.first, corners.first + 1, corners.first + below,
                               corners.first + below + 1};
  for (std::size_t k = 0; k < 4; ++k) {
    const double share = corners.shares[static_cast<Eigen::Index>(k)] * weight * white;
    push_[nodes[k]] += share * residual;
    weight_[nodes[k]] += share * white;
  }
}

double TagLight::mean_of_neighbours(int column, int row, int* count) const {
  double sum = 0.0;
  *count = 0;
  const auto add = [&](int x, int y) {
    if (x < 0 || y < 0 || x >= num_nodes_ || y >= num_nodes_) return;
    sum += excess_[static_cast<Eigen::Index>(y) * num_nodes_ + x];
    ++*count;
  };
  add(column - 1, row);
  add(column + 1, row);
  add(column, row - 1);
  add(column, row + 1);
  return sum / *count;
}

void TagLight::update(const Sums& sums) {
  double total = 0.0;
  int num_seen = 0;
  for (const double weight : sums.weight_) {
    total += weight;
    if (weight > 0.0) ++num_seen;
  }
  if (num_seen == 0) return;
  const double stiffness = kStiffness * total / num_seen;
  Eigen::VectorXd target = excess_;
  for (std::size_t i = 0; i < size(); ++i) {
    if (sums.weight_[i] > 0.0) target[static_cast<Eigen::Index>(i)] += sums.push_[i] / sums.weight_[i];
  }
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (int row = 0; row < num_nodes_; ++row) {
      for (int column = 0; column < num_nodes_; ++column) {
        const Eigen::Index i = static_cast<Eigen::Index>(row) * num_nodes_ + column;
        int num_neighbours = 0;
        const double mean = mean_of_neighbours(column, row, &num_neighbours);
        const double weight = sums.weight_[static_cast<std::size_t>(i)], tie = stiffness * num_neighbours;
        excess_[i] = (weight * target[i] + tie * mean) / (weight + tie + kPullToEven * stiffness);
      }
    }
  }
}

}  // namespace apriltrack
