#include "apriltrack/tags/blurred_pattern.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdlib>

namespace apriltrack {
namespace {

/// Beyond so many sigmas a Gaussian weighs less than 1e-6.
constexpr double kBlurReach = 5.0;
/// Under a blur that reaches farther, cells cannot be told apart: what is cut off then hardly matters.
constexpr int kMaxCells = 16;
/// Up to this correlation the series of equation (2) leaves less than 1e-3 of the contrast.
constexpr double kMaxSeriesCorrelation = 0.3;
/// A row of Gaussians of equal width so far apart, in their sigmas, adds up to a smooth one: ripples of
/// 2 exp(-2 (pi / 1.4)^2), 1e-4 of what is smeared along the row.
constexpr double kNodeSpacing = 1.4;
/// The row ends where the weights fall under 2 % of the middle's.
constexpr double kRowReach = 2.8;

/// How much of a one-dimensional Gaussian falls on each of the cells about its centre.
struct CellShares {
  int first = 0;
  int count = 0;
  std::array<double, kMaxCells> share, by_place, by_place2;
  double before = 0.0, after = 0.0;  ///< What falls beyond the first and the last cell of all.
};

struct Step {
  double below, by_place, by_place2;
};

/// Of a Gaussian whose centre lies `distance` beyond an edge: what lies beyond the edge.
Step beyond(const NormalTable& normal, double per_sigma, double distance) {
  const double z = distance * per_sigma;
  const auto [below, density] = normal.at(z);
  const double by_place = density * per_sigma;
  return {below, by_place, -z * by_place * per_sigma};
}

CellShares cell_shares(double place, double begin, double cell, int num_cells, double sigma) {
  const NormalTable& normal = NormalTable::get();
  const double per_sigma = 1.0 / sigma;
  const double from_begin = place - begin, centre = from_begin / cell, reach = kBlurReach * sigma / cell;
  int first = static_cast<int>(std::clamp(std::floor(centre - reach), 0.0, static_cast<double>(num_cells)));
  int last = static_cast<int>(std::clamp(std::floor(centre + reach), -1.0, num_cells - 1.0));
  if (last - first >= kMaxCells) {
    first = std::clamp(static_cast<int>(centre) - kMaxCells / 2, 0, num_cells - kMaxCells);
    last = first + kMaxCells - 1;
  }
  CellShares shares;
  shares.first = first;
  Step left = beyond(normal, per_sigma, from_begin - first * cell);
  shares.before = first == 0 ? 1.0 - left.below : 0.0;
  for (int k = first; k <= last; ++k) {
    const Step right = beyond(normal, per_sigma, from_begin - (k + 1) * cell);
    const auto i = static_cast<std::size_t>(shares.count++);
    shares.share[i] = left.below - right.below;
    shares.by_place[i] = left.by_place - right.by_place;
    shares.by_place2[i] = left.by_place2 - right.by_place2;
    left = right;
  }
  if (last < first) {  // wholly on one side
    shares.before = centre < 0.0 ? 1.0 : 0.0;
    shares.after = 1.0 - shares.before;
  } else if (last == num_cells - 1) {
    shares.after = left.below;
  }
  return shares;
}

/// A blur as a less correlated one, smeared once more along a diagonal of the two sigmas: by a row of nodes.
struct RowOfNodes {
  /// max_correlation: of the rest.
  RowOfNodes(const PatternBlur& blur, double max_correlation) : rest(blur) {
    const double correlation = blur.correlation();
    if (correlation <= max_correlation) return;
    const double share = std::min(0.95, (correlation - max_correlation) / (1.0 - max_correlation));
    const double along = std::sqrt(share), left_over = std::sqrt(1.0 - share);
    const double sign = blur.covariance_uv > 0.0 ? 1.0 : -1.0;
    rest = {left_over * blur.sigma_u, left_over * blur.sigma_v,
            blur.covariance_uv - sign * share * blur.sigma_u * blur.sigma_v};
    const double spacing = std::min(kNodeSpacing * left_over, 1.5 * along);
    reach = static_cast<int>(std::ceil(kRowReach * along / spacing - 0.5));
    double variance = 0.0, sum = 0.0;
    for (int k = 0; k <= reach; ++k) {
      const double z = k * spacing / along, weight = std::exp(-0.5 * z * z);
      weights[static_cast<std::size_t>(k)] = weight;
      const double of_both = (k == 0 ? 1.0 : 2.0) * weight;
      sum += of_both;
      variance += of_both * z * z;
    }
    for (double& weight : weights) weight /= sum;
    const double stretch = std::sqrt(sum / variance);  // the row's variance is exact
    step_u = spacing * stretch * blur.sigma_u;
    step_v = sign * spacing * stretch * blur.sigma_v;
  }

  double weight(int k) const { return weights[static_cast<std::size_t>(std::abs(k))]; }
  double shift_u(int k) const { return k * step_u; }
  double shift_v(int k) const { return k * step_v; }

  PatternBlur rest;
  static constexpr int kMaxReach = 9;                 ///< At a share of 0.95.
  int reach = 0;                                      ///< Nodes from -reach to reach.
  std::array<double, kMaxReach + 1> weights = {1.0};  ///< By how far from the middle.
  double step_u = 0.0, step_v = 0.0;
};

void add(double weight, const PatternSample& sample, PatternSample& sum) {
  sum.light += weight * sample.light;
  sum.by_u += weight * sample.by_u;
  sum.by_v += weight * sample.by_v;
  sum.by_uu += weight * sample.by_uu;
  sum.by_uv += weight * sample.by_uv;
  sum.by_vv += weight * sample.by_vv;
  sum.known += weight * sample.known;
  for (std::size_t side = 0; side < sum.beyond.size(); ++side)
    sum.beyond[side] += weight * sample.beyond[side];
}

}  // namespace

BlurredPattern::BlurredPattern(const TagPattern& pattern)
    : begin_(-pattern.half_extent()), cell_(pattern.cell_size()), num_cells_(pattern.cells().width()) {
  black_.resize(num_cells_, num_cells_);
  known_.resize(num_cells_, num_cells_);
  for (int y = 0; y < num_cells_; ++y) {
    for (int x = 0; x < num_cells_; ++x) {
      const float cell = pattern.cells()(x, y);
      const bool is_known = !std::isnan(cell);
      black_(y, x) = is_known ? 1.0 - static_cast<double>(cell) : 0.0;
      known_(y, x) = is_known ? 1.0 : 0.0;
      has_unknown_cells_ |= !is_known;
    }
  }
}

PatternSample BlurredPattern::at(double u, double v, const PatternBlur& blur) const {
  if (blur.correlation() <= kMaxSeriesCorrelation) return smeared_along_axes(u, v, blur);
  const RowOfNodes row(blur, kMaxSeriesCorrelation);
  PatternSample sum;
  for (int k = -row.reach; k <= row.reach; ++k)
    add(row.weight(k), smeared_along_axes(u - row.shift_u(k), v - row.shift_v(k), row.rest), sum);
  return sum;
}

BlurredPattern::Grid BlurredPattern::on_grid(const Eigen::VectorXd& places, const PatternBlur& blur) const {
  // Up to there two more terms of the series are cheaper than a row, beyond it more nodes than terms.
  const bool is_series = blur.correlation() <= kMaxSeriesCorrelation;
  const RowOfNodes row(blur, is_series ? kMaxSeriesCorrelation : 0.0);
  const Eigen::Index n = places.size();
  // Shares of the cells at each place, and their first and second derivatives: dense, for most are not zero.
  using Shares = std::array<Eigen::MatrixXd, 3>;
  const auto shares_along = [&](double shift, double sigma) {
    Shares shares;
    for (Eigen::MatrixXd& one : shares) one = Eigen::MatrixXd::Zero(n, num_cells_);
    for (Eigen::Index i = 0; i < n; ++i) {
      const CellShares at = cell_shares(places[i] - shift, begin_, cell_, num_cells_, sigma);
      for (Eigen::Index k = 0; k < at.count; ++k) {
        const auto of = static_cast<std::size_t>(k);
        shares[0](i, at.first + k) = at.share[of];
        shares[1](i, at.first + k) = at.by_place[of];
        shares[2](i, at.first + k) = at.by_place2[of];
      }
    }
    return shares;
  };
  Grid grid;
  grid.light = Eigen::MatrixXd::Ones(n, n);
  if (has_unknown_cells_) grid.known = Eigen::MatrixXd::Zero(n, n);
  const double first = is_series ? row.rest.covariance_uv : 0.0;
  const double series[] = {1.0, first, 0.5 * first * first};
  for (int k = -row.reach; k <= row.reach; ++k) {
    const Shares along_u = shares_along(row.shift_u(k), row.rest.sigma_u);
    const Shares along_v = shares_along(row.shift_v(k), row.rest.sigma_v);
    for (std::size_t term = 0; term < 3; ++term) {
      if (series[term] == 0.0) break;
      const Eigen::MatrixXd of_rows = black_ * along_u[term].transpose();
      grid.light.noalias() -= row.weight(k) * series[term] * along_v[term] * of_rows;
    }
    if (!has_unknown_cells_) continue;
    const Eigen::MatrixXd of_rows = known_ * along_u[0].transpose();
    grid.known.noalias() += row.weight(k) * along_v[0] * of_rows;
  }
  grid.beyond.resize(kNumPatternSides, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const CellShares u = cell_shares(places[i], begin_, cell_, num_cells_, blur.sigma_u);
    const CellShares v = cell_shares(places[i], begin_, cell_, num_cells_, blur.sigma_v);
    grid.beyond.col(i) << u.before, u.after, v.before, v.after;
  }
  return grid;
}

PatternSample BlurredPattern::smeared_along_axes(double u, double v, const PatternBlur& blur) const {
  const CellShares columns = cell_shares(u, begin_, cell_, num_cells_, blur.sigma_u);
  const CellShares rows = cell_shares(v, begin_, cell_, num_cells_, blur.sigma_v);
  const double first = blur.covariance_uv, second = 0.5 * first * first;
  PatternSample sample;
  sample.light = 1.0;
  const auto num_columns = static_cast<std::size_t>(columns.count);
  for (std::size_t r = 0; r < static_cast<std::size_t>(rows.count); ++r) {
    const auto offset = (rows.first + static_cast<int>(r)) * num_cells_ + columns.first;
    const double* black = black_.data() + offset;
    const double* printed = known_.data() + offset;
    double light = 0.0, by_u = 0.0, by_u2 = 0.0, known = 0.0;
    for (std::size_t c = 0; c < num_columns; ++c) {
      known += printed[c] * columns.share[c];
      light -= black[c] * columns.share[c];
      by_u -= black[c] * columns.by_place[c];
      by_u2 -= black[c] * columns.by_place2[c];
    }
    const double share = rows.share[r], by_v = rows.by_place[r], by_v2 = rows.by_place2[r];
    sample.known += share * known;
    sample.light += share * light + first * by_v * by_u + second * by_v2 * by_u2;
    sample.by_u += share * by_u + first * by_v * by_u2;
    sample.by_v += by_v * light + first * by_v2 * by_u;
    sample.by_uu += share * by_u2;
    sample.by_uv += by_v * by_u + first * by_v2 * by_u2;
    sample.by_vv += by_v2 * light;
  }
  sample.beyond = {columns.before, columns.after, rows.before, rows.after};
  return sample;
}

}  // namespace apriltrack
