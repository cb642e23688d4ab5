#include "pattern_correlation.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "apriltrack/geometry/homography.h"
#include "tag_quad.h"

namespace apriltrack {
namespace {

constexpr int kPointsPerSide = 24;  // three or four for each cell
/// Of the blur along an axis, in cells: sharp, as far as pixels allow, to hardly readable.
constexpr std::array kBlurs_cells = {0.2, 0.45, 0.8};
/// White margins are cut as narrow as 0.3 cells, and what lies beyond is not the tag's.
constexpr double kMargin_cells = 0.25;
constexpr int kNumTerms = 6;

using Weights = Eigen::MatrixXd;  // points x cells: how much of each cell a point shows

double half_width(const TagPattern& pattern, bool is_white_inside) {
  // Families with a reversed border have black and data outside the detected square.
  return is_white_inside ? pattern.half_extent() : 1.0 + kMargin_cells * pattern.cell_size();
}

double coordinate(int i, double half_width) {
  return half_width * ((2 * i + 1.0) / kPointsPerSide - 1.0);
}

/// The outermost cells go on for ever.
Weights blur_weights(const TagPattern& pattern, double half_width, int num_cells, double blur_cells) {
  Weights weights(kPointsPerSide, num_cells);
  for (int i = 0; i < kPointsPerSide; ++i) {
    const double place = coordinate(i, half_width) / pattern.cell_size() + 0.5 * num_cells;
    const auto below = [&](int edge) {
      return 0.5 * std::erfc((place - edge) / (blur_cells * std::numbers::sqrt2));
    };
    for (int cell = 0; cell < num_cells; ++cell) {
      const double low = cell == 0 ? 0.0 : below(cell);
      const double high = cell == num_cells - 1 ? 1.0 : below(cell + 1);
      weights(i, cell) = high - low;
    }
  }
  return weights;
}

/// With a ring of paper around; what is not printed is paper.
Eigen::MatrixXd cells_on_paper(const TagPattern& pattern) {
  const Image<float>& cells = pattern.cells();
  Eigen::MatrixXd all = Eigen::MatrixXd::Ones(cells.height() + 2, cells.width() + 2);
  for (int y = 0; y < cells.height(); ++y)
    for (int x = 0; x < cells.width(); ++x)
      if (!std::isnan(cells(x, y))) all(y + 1, x + 1) = cells(x, y);
  return all;
}

/// The share of the light's variance that the model leaves, 1 where its contrast is reversed.
double unexplained(const Eigen::VectorXd& light, const Eigen::MatrixXd& terms) {
  using Square = Eigen::Matrix<double, kNumTerms, kNumTerms>;
  using Column = Eigen::Matrix<double, kNumTerms, 1>;
  const Square normal = terms.transpose() * terms;
  const Column right = terms.transpose() * light;
  const Column solution = normal.ldlt().solve(right);
  constexpr int kContrast = 3;
  if (!(solution(kContrast) > 0.0)) return 1.0;
  const double all = (light.array() - light.mean()).matrix().squaredNorm();
  return all > 0.0 ? std::min(1.0, (light - terms * solution).squaredNorm() / all) : 1.0;
}

}  // namespace

double pattern_correlation(const LightSampler& light, const TagPattern& pattern, bool is_white_inside,
                           const Quad& corners_px, double enough) {
  const auto homography = estimate_homography(kTagQuad, corners_px);
  if (!homography) return 0.0;
  const double reach = half_width(pattern, is_white_inside);
  Eigen::VectorXd seen(kPointsPerSide * kPointsPerSide);
  Eigen::MatrixXd terms(kPointsPerSide * kPointsPerSide, kNumTerms);
  for (int row = 0; row < kPointsPerSide; ++row) {
    for (int column = 0; column < kPointsPerSide; ++column) {
      const Eigen::Vector2d point(coordinate(column, reach), coordinate(row, reach));
      const auto value = light.at((*homography * point.homogeneous()).hnormalized());
      if (!value) return 0.0;
      seen(row * kPointsPerSide + column) = *value;
      terms.row(row * kPointsPerSide + column).head<3>() << 1.0, point.x(), point.y();
    }
  }
  const Eigen::MatrixXd cells = cells_on_paper(pattern);
  std::vector<Weights> weights;
  for (const double blur_cells : kBlurs_cells)
    weights.push_back(blur_weights(pattern, reach, static_cast<int>(cells.rows()), blur_cells));
  double best = 0.0;
  for (const Weights& down : weights) {
    for (const Weights& across : weights) {
      const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> picture =
          down * cells * across.transpose();
      const Eigen::Map<const Eigen::VectorXd> blurred(picture.data(), picture.size());
      for (int term = 0; term < 3; ++term) terms.col(3 + term) = terms.col(term).cwiseProduct(blurred);
      best = std::max(best, std::sqrt(1.0 - unexplained(seen, terms)));
      if (best >= enough) return best;
    }
  }
  return best;
}

}  // namespace apriltrack
