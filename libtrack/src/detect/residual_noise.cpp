#include "residual_noise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

namespace apriltrack {
namespace {

/// How far errors reach, measured on residuals of path-traced pictures (JPEG of quality 95: correlations of
/// 0.37 to 0.40, 0.25, 0.15 and 0.08 over 1 to 4 px in one renderer's, 0.26, 0.13 and 0.04 in the other's).
/// 0.8^d (1 - d/5) is 0.64, 0.38, 0.20 and 0.08 over 1 to 4 px: the same but for a factor.
constexpr double kDecayPerPixel = 0.8;
/// What is taken for c before residuals are looked at, as if so many pairs had shown it.
constexpr double kPriorCorrelation = 0.4, kPriorPairs = 100.0;
constexpr double kMaxCorrelation = 0.95;
/// Of the mean variance, at least: grain that the robust weights took away.
constexpr double kMinShareOfVariance = 0.2;

/// How alike errors are over so many pixels along one axis. Both factors have spectra that are nowhere
/// negative (of an autoregressive process; of a triangle: Bartlett 1950), so their product has, too.
template <std::size_t N>
std::array<double, N> tapered_decay() {
  std::array<double, N> decay{};
  for (std::size_t d = 0; d < N; ++d)
    decay[d] = std::pow(kDecayPerPixel, static_cast<double>(d)) *
               (1.0 - static_cast<double>(d) / static_cast<double>(N));
  return decay;
}

}  // namespace

ResidualNoise::ResidualNoise(std::vector<FittedPixel> pixels, int num_unknowns) : pixels_(std::move(pixels)) {
  if (pixels_.empty()) return;
  int x1 = pixels_.front().x, y1 = pixels_.front().y;
  x0_ = x1, y0_ = y1;
  for (const FittedPixel& pixel : pixels_) {
    x0_ = std::min(x0_, pixel.x), x1 = std::max(x1, pixel.x);
    y0_ = std::min(y0_, pixel.y), y1 = std::max(y1, pixel.y);
  }
  width_ = x1 - x0_ + 1, height_ = y1 - y0_ + 1;
  index_.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_), -1);
  for (std::size_t i = 0; i < pixels_.size(); ++i)
    index_[static_cast<std::size_t>((pixels_[i].y - y0_) * width_ + pixels_[i].x - x0_)] =
        static_cast<int>(i);
  fit_variances(num_unknowns);
  fit_correlation();
}

void ResidualNoise::fit_variances(int num_unknowns) {
  // All pixels count alike: weights are small where residuals are large, so a mean by weights is too small.
  double n = 0.0, g = 0.0, gg = 0.0, r = 0.0, rg = 0.0;
  for (const FittedPixel& pixel : pixels_) {
    if (!pixel.counts) continue;
    const double r2 = pixel.residual * pixel.residual;
    n += 1.0, g += pixel.gradient2, gg += pixel.gradient2 * pixel.gradient2;
    r += r2, rg += r2 * pixel.gradient2;
  }
  const double mean = r / std::max(n, 1.0), determinant = n * gg - g * g;
  double beta = determinant > 1e-9 * n * gg ? std::max(0.0, (n * rg - g * r) / determinant) : 0.0;
  double alpha = n > 0.0 ? (r - beta * g) / n : 0.0;
  if (alpha < kMinShareOfVariance * mean) {
    alpha = kMinShareOfVariance * mean;
    beta = g > 0.0 ? std::max(0.0, (r - alpha * n) / g) : 0.0;
  }
  const double freedom = std::max(n - num_unknowns, 0.1 * n) / std::max(n, 1.0);
  sigmas_.resize(static_cast<Eigen::Index>(pixels_.size()));
  for (std::size_t i = 0; i < pixels_.size(); ++i)
    sigmas_[static_cast<Eigen::Index>(i)] = std::sqrt((alpha + beta * pixels_[i].gradient2) / freedom);
}

template <class Visit>
void ResidualNoise::for_pairs(const Visit& visit) const {
  const auto decay = tapered_decay<kReach_px + 1>();
  for (std::size_t i = 0; i < pixels_.size(); ++i) {
    const int x = pixels_[i].x - x0_, y = pixels_[i].y - y0_;
    for (int dy = 0; dy <= std::min(kReach_px, height_ - 1 - y); ++dy) {
      const int begin = std::max(0, dy == 0 ? x + 1 : x - kReach_px);
      const int end = std::min(width_ - 1, x + kReach_px);
      const int* row = index_.data() + (y + dy) * width_;
      for (int other = begin; other <= end; ++other)
        if (row[other] >= 0)
          visit(static_cast<int>(i), row[other],
                decay[static_cast<std::size_t>(dy)] * decay[static_cast<std::size_t>(std::abs(other - x))]);
    }
  }
}

void ResidualNoise::fit_correlation() {
  const double of_prior = tapered_decay<kReach_px + 1>()[1];
  double norm = kPriorPairs * of_prior * of_prior, along = norm * kPriorCorrelation;
  for_pairs([&](int i, int j, double decay) {
    const FittedPixel &a = pixels_[static_cast<std::size_t>(i)], &b = pixels_[static_cast<std::size_t>(j)];
    if (!a.counts || !b.counts) return;
    along += decay * a.residual * b.residual / (sigmas_[i] * sigmas_[j]);
    norm += decay * decay;
  });
  correlation_ = std::clamp(along / norm, 0.0, kMaxCorrelation);
}

Eigen::Matrix<double, 8, 8> ResidualNoise::covariance_of_sum(
    Eigen::Matrix<double, 8, Eigen::Dynamic> influence) const {
  influence *= sigmas_.asDiagonal();
  Eigen::Matrix<double, 8, Eigen::Dynamic> near = 0.5 * influence;
  for_pairs([&](int i, int j, double decay) { near.col(i) += correlation_ * decay * influence.col(j); });
  const Eigen::Matrix<double, 8, 8> half = near * influence.transpose();
  return half + half.transpose();
}

}  // namespace apriltrack
