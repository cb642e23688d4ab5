#include "apriltrack/photometric/pattern_texture.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace apriltrack {
namespace {

constexpr double kTexelsPerSigma = 4.0 / 3.0;
constexpr double kMinTexelsPerCell = 8.0;
constexpr double kMaxTexelsPerCell = 48.0;
/// Linear interpolation blurs by about a sixth of a texel squared.
constexpr double kInterpolationVariance = 1.0 / 6.0;
/// Beyond so many sigmas a Gaussian weighs less than 0.2 %.
constexpr double kReachInSigmas = 3.0;

double normal_cdf(double x) {
  return 0.5 * std::erfc(-x / std::numbers::sqrt2);
}

std::uint16_t rounded(double share) {
  return static_cast<std::uint16_t>(static_cast<double>(Texel::kOne) * std::clamp(share, 0.0, 1.0) + 0.5);
}

/// The texels along one axis of the plane.
struct TexelAxis {
  int count = 0;
  double half_length = 0.0;
  double texels_per_unit = 0.0;
  Eigen::MatrixXd cell_shares;  ///< Row i: how much of a Gaussian about texel i falls on each cell.
};

TexelAxis texel_axis(const TagPattern& pattern, double sigma) {
  const double cell = pattern.cell_size();
  const double texels_per_cell =
      std::ceil(std::clamp(kTexelsPerSigma * cell / sigma, kMinTexelsPerCell, kMaxTexelsPerCell));
  const double texel = cell / texels_per_cell;
  const double kernel =
      std::sqrt(std::max(sigma * sigma - kInterpolationVariance * texel * texel, 0.01 * texel * texel));
  const int half = static_cast<int>(std::ceil((pattern.half_extent() + kReachInSigmas * sigma) / texel));
  const int num_cells = pattern.cells().width();
  TexelAxis axis{2 * half + 1, half * texel, 1.0 / texel, {}};
  axis.cell_shares.resize(axis.count, num_cells);
  for (int i = 0; i < axis.count; ++i) {
    const double centre = (i - half) * texel;
    const auto share_up_to = [&](int k) {
      return normal_cdf(((k - 0.5 * num_cells) * cell - centre) / kernel);
    };
    double below = share_up_to(0);
    for (int k = 0; k < num_cells; ++k) {
      const double up_to_here = share_up_to(k + 1);
      axis.cell_shares(i, k) = up_to_here - below;
      below = up_to_here;
    }
  }
  return axis;
}

/// What is known of the cells, row by row. Those that the family leaves to the printer count as beyond the
/// tag.
struct KnownCells {
  Eigen::MatrixXd light, presence;
};

KnownCells known_cells(const TagPattern& pattern) {
  const int n = pattern.cells().width();
  KnownCells known{Eigen::MatrixXd::Zero(n, n), Eigen::MatrixXd::Zero(n, n)};
  for (int row = 0; row < n; ++row) {
    for (int column = 0; column < n; ++column) {
      const double value = pattern.cells()(column, row);
      if (std::isnan(value)) continue;
      known.light(row, column) = value;
      known.presence(row, column) = 1.0;
    }
  }
  return known;
}

}  // namespace

PatternTexture::PatternTexture(const TagPattern& pattern, double sigma_u, double sigma_v) {
  const TexelAxis u = texel_axis(pattern, sigma_u);
  const TexelAxis v = texel_axis(pattern, sigma_v);
  grid_ = {.texels = nullptr,
           .width = u.count,
           .half_width = static_cast<float>(u.half_length),
           .half_height = static_cast<float>(v.half_length),
           .columns_per_unit = static_cast<float>(u.texels_per_unit),
           .rows_per_unit = static_cast<float>(v.texels_per_unit),
           .last_column = static_cast<float>(u.count - 1),
           .last_row = static_cast<float>(v.count - 1)};
  const KnownCells known = known_cells(pattern);
  const Eigen::MatrixXd light = v.cell_shares * known.light * u.cell_shares.transpose();
  // Most families print all of their cells: a product of sums then.
  const Eigen::MatrixXd presence =
      known.presence.minCoeff() > 0.0
          ? Eigen::MatrixXd(v.cell_shares.rowwise().sum() * u.cell_shares.rowwise().sum().transpose())
          : Eigen::MatrixXd(v.cell_shares * known.presence * u.cell_shares.transpose());
  texels_.reserve(static_cast<std::size_t>(light.size()));
  for (int row = 0; row < v.count; ++row) {
    for (int column = 0; column < u.count; ++column)
      texels_.push_back({rounded(light(row, column)), rounded(presence(row, column))});
  }
}

PatternSample PatternTexture::sample_texels(float column, float row, PatternGradient* gradient) const {
  if (gradient != nullptr) *gradient = {};
  if (!(column >= 0.0F && row >= 0.0F && column < grid_.last_column && row < grid_.last_row)) return {};
  const int left = static_cast<int>(column), top = static_cast<int>(row);
  const float fx = column - static_cast<float>(left), fy = row - static_cast<float>(top);
  const Texel *a = texels_.data() + top * grid_.width + left, *b = a + grid_.width;
  const auto between = [&](std::uint16_t Texel::*value, float* by_column, float* by_row) {
    const auto of = [&](const Texel& texel) { return static_cast<float>(texel.*value) / Texel::kOne; };
    const float left_edge = of(a[0]) + fy * (of(b[0]) - of(a[0]));
    const float right_edge = of(a[1]) + fy * (of(b[1]) - of(a[1]));
    if (by_column != nullptr) *by_column = right_edge - left_edge;
    if (by_row != nullptr) *by_row = (1.0F - fx) * (of(b[0]) - of(a[0])) + fx * (of(b[1]) - of(a[1]));
    return left_edge + fx * (right_edge - left_edge);
  };
  PatternGradient unused;
  PatternGradient& by = gradient != nullptr ? *gradient : unused;
  return {between(&Texel::light, &by.light_u, &by.light_v),
          between(&Texel::presence, &by.presence_u, &by.presence_v)};
}

}  // namespace apriltrack
