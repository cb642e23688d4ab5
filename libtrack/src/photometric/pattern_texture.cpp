#include "apriltrack/photometric/pattern_texture.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace apriltrack {
namespace {

constexpr double kTexelsPerCell = 8.0;
/// Beyond so many sigmas a Gaussian weighs less than 0.2 %.
constexpr double kReachInSigmas = 3.0;
constexpr double kMaxSigmaInCells = 3.0;
constexpr double kStepsPerOctave = 4.0;
constexpr std::size_t kMaxTextures = 64;

double normal_cdf(double x) { return 0.5 * std::erfc(-x / std::numbers::sqrt2); }

/// Row i: how much of a Gaussian about texel i falls on each cell.
Eigen::MatrixXd cell_shares(int num_texels, double half_width, double texel, double sigma, int num_cells, double cell) {
  Eigen::MatrixXd shares(num_texels, num_cells);
  const double first_edge = -0.5 * num_cells * cell;
  for (int i = 0; i < num_texels; ++i) {
    const double centre = i * texel - half_width;
    for (int k = 0; k < num_cells; ++k) {
      const double low = (first_edge + k * cell - centre) / sigma;
      shares(i, k) = normal_cdf(low + cell / sigma) - normal_cdf(low);
    }
  }
  return shares;
}

Eigen::MatrixXd brightness_of_cells(const TagPattern& pattern) {
  const int n = pattern.cells().width();
  Eigen::MatrixXd brightness(n, n);
  for (int row = 0; row < n; ++row) {
    for (int column = 0; column < n; ++column) {
      const double value = pattern.cells()(column, row);
      brightness(row, column) = std::isnan(value) ? 1.0 : value;
    }
  }
  return brightness;
}

int level_of(double sigma) { return static_cast<int>(std::lround(kStepsPerOctave * std::log2(sigma))); }
double sigma_of(int level) { return std::exp2(level / kStepsPerOctave); }

}  // namespace

PatternTexture::PatternTexture(const TagPattern& pattern, double sigma_u, double sigma_v) {
  const double cell = pattern.cell_size();
  const double texel = cell / kTexelsPerCell;
  sigma_u = std::max(sigma_u, 0.5 * texel);
  sigma_v = std::max(sigma_v, 0.5 * texel);
  const double reach = kReachInSigmas * std::max(sigma_u, sigma_v);
  const int half = static_cast<int>(std::ceil((pattern.half_extent() + reach) / texel));
  width_ = 2 * half + 1;
  half_width_ = static_cast<float>(half * texel);
  scale_ = static_cast<float>(1.0 / texel);
  limit_ = static_cast<float>(width_ - 1);

  const int num_cells = pattern.cells().width();
  const Eigen::MatrixXd across = cell_shares(width_, half * texel, texel, sigma_u, num_cells, cell);
  const Eigen::MatrixXd down = cell_shares(width_, half * texel, texel, sigma_v, num_cells, cell);
  const Eigen::MatrixXd light = down * brightness_of_cells(pattern) * across.transpose();
  const Eigen::MatrixXd presence = down.rowwise().sum() * across.rowwise().sum().transpose();
  texels_.reserve(static_cast<std::size_t>(width_) * static_cast<std::size_t>(width_));
  for (int row = 0; row < width_; ++row) {
    for (int column = 0; column < width_; ++column)
      texels_.emplace_back(static_cast<float>(light(row, column)), static_cast<float>(presence(row, column)));
  }
}

std::shared_ptr<const PatternTexture> PatternTextures::blurred(double sigma_u, double sigma_v) {
  const double cell = pattern_.cell_size();
  const auto level = [&](double sigma) {
    return level_of(std::clamp(sigma, 0.5 * cell / kTexelsPerCell, kMaxSigmaInCells * cell));
  };
  const int level_u = level(sigma_u), level_v = level(sigma_v);
  const auto found = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& entry) {
    return entry.level_u == level_u && entry.level_v == level_v;
  });
  if (found != entries_.end()) {
    std::rotate(found, found + 1, entries_.end());
    return entries_.back().texture;
  }
  if (entries_.size() == kMaxTextures) entries_.erase(entries_.begin());
  entries_.push_back({level_u, level_v,
                      std::make_shared<const PatternTexture>(pattern_, sigma_of(level_u), sigma_of(level_v))});
  return entries_.back().texture;
}

}  // namespace apriltrack
