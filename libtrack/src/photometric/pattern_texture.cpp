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

/// Beyond so many sigmas it weighs less than any texel tells.
constexpr double kReachOfTexels = 5.0;

/// The texels along one axis of the plane.
struct TexelAxis {
  int count = 0;
  double half_length = 0.0;
  double texels_per_unit = 0.0;
  Eigen::MatrixXf cell_shares;  ///< Row i: how much of a Gaussian about texel i falls on each cell.
};

TexelAxis texel_axis(const TagPattern& pattern, double sigma) {
  const double cell = pattern.cell_size();
  const int texels_per_cell = static_cast<int>(
      std::ceil(std::clamp(kTexelsPerSigma * cell / sigma, kMinTexelsPerCell, kMaxTexelsPerCell)));
  const double texel = cell / texels_per_cell;
  const double kernel =
      std::sqrt(std::max(sigma * sigma - kInterpolationVariance * texel * texel, 0.01 * texel * texel));
  const int half = static_cast<int>(std::ceil((pattern.half_extent() + kReachInSigmas * sigma) / texel));
  const int num_cells = pattern.cells().width();
  TexelAxis axis{2 * half + 1, half * texel, 1.0 / texel, {}};
  // Cells begin a whole number of texels apart: few distances between them and the texels differ.
  Eigen::VectorXf share_up_to(axis.count + num_cells * texels_per_cell);
  for (int i = 0; i < share_up_to.size(); ++i) {
    const double distance = (i + 1 - axis.count + half - 0.5 * num_cells * texels_per_cell) * texel / kernel;
    share_up_to[i] = std::abs(distance) < kReachOfTexels ? static_cast<float>(normal_cdf(distance))
                                                         : (distance > 0.0 ? 1.0F : 0.0F);
  }
  axis.cell_shares.resize(axis.count, num_cells);
  for (int k = 0; k < num_cells; ++k) {
    const auto begins = share_up_to.segment(k * texels_per_cell, axis.count);
    const auto ends = share_up_to.segment((k + 1) * texels_per_cell, axis.count);
    axis.cell_shares.col(k) = (ends - begins).reverse();
  }
  return axis;
}

/// What is known of the cells, row by row. Those that the family leaves to the printer count as beyond the
/// tag.
struct KnownCells {
  Eigen::MatrixXf light, presence;
};

KnownCells known_cells(const TagPattern& pattern) {
  const int n = pattern.cells().width();
  KnownCells known{Eigen::MatrixXf::Zero(n, n), Eigen::MatrixXf::Zero(n, n)};
  for (int row = 0; row < n; ++row) {
    for (int column = 0; column < n; ++column) {
      const float value = pattern.cells()(column, row);
      if (std::isnan(value)) continue;
      known.light(row, column) = value;
      known.presence(row, column) = 1.0F;
    }
  }
  return known;
}

/// Cells blurred along their rows: what a row of texels is made of.
class BlurredRows {
 public:
  BlurredRows(const Eigen::MatrixXf& cells, const TexelAxis& columns)
      : rows_(columns.cell_shares * cells.transpose()) {}

  /// In Texel::kOne-ths, rounded to the nearest. shares: of each row of cells.
  template <class Shares>
  void blur(const Shares& shares, Eigen::VectorXi& texels) {
    sum_.setConstant(rows_.rows(), 0.5F);
    for (Eigen::Index k = 0; k < shares.size(); ++k)  // a few only are near
      if (shares[k] != 0.0F) sum_ += Texel::kOne * shares[k] * rows_.col(k);
    texels = sum_.cwiseMax(0.5F).cwiseMin(Texel::kOne + 0.5F).template cast<int>();
  }

 private:
  Eigen::MatrixXf rows_;
  Eigen::VectorXf sum_;
};

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
  BlurredRows light(known.light, u), presence(known.presence, u);
  texels_.resize(static_cast<std::size_t>(u.count) * static_cast<std::size_t>(v.count));
  Texel* texel = texels_.data();
  Eigen::VectorXi line_light, line_presence;
  for (int row = 0; row < v.count; ++row) {
    light.blur(v.cell_shares.row(row), line_light);
    presence.blur(v.cell_shares.row(row), line_presence);
    for (int column = 0; column < u.count; ++column, ++texel) {
      *texel = {static_cast<std::uint16_t>(line_light[column]),
                static_cast<std::uint16_t>(line_presence[column])};
    }
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
