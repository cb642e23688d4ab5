#include "residual_noise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <numbers>
#include <vector>

namespace apriltrack {
namespace {

constexpr int kSide_px = 20;
constexpr int kNumUnknowns = 24;

/// A square of pixels that all err alike.
std::vector<FittedPixel> pixels_alike() {
  std::vector<FittedPixel> pixels;
  for (int y = 0; y < kSide_px; ++y)
    for (int x = 0; x < kSide_px; ++x) pixels.push_back({100 + x, 50 + y, 0.02, true, 0.0});
  return pixels;
}

/// By rows: waves of eight lengths and directions.
Eigen::Matrix<double, 8, Eigen::Dynamic> waves(const std::vector<FittedPixel>& pixels, int first) {
  Eigen::Matrix<double, 8, Eigen::Dynamic> influence(8, pixels.size());
  for (int wave = 0; wave < 8; ++wave) {
    const double per_x = std::numbers::pi * (first + wave) / 16.0, per_y = std::numbers::pi * first / 16.0;
    for (std::size_t i = 0; i < pixels.size(); ++i)
      influence(wave, static_cast<Eigen::Index>(i)) = std::cos(per_x * pixels[i].x + per_y * pixels[i].y);
  }
  return influence;
}

TEST(ResidualNoise, IsTheSumOverAllPairs) {
  const std::vector<FittedPixel> pixels = pixels_alike();
  const auto influence = waves(pixels, 0);
  const auto k = [](int d) { return std::pow(0.8, std::abs(d)) * std::max(0.0, 1.0 - std::abs(d) / 5.0); };
  // Pixels that err alike have the largest c that is taken, 0.95.
  Eigen::Matrix<double, 8, 8> expected = Eigen::Matrix<double, 8, 8>::Zero();
  const double n = static_cast<double>(pixels.size()), variance = 0.02 * 0.02 * n / (n - kNumUnknowns);
  for (std::size_t i = 0; i < pixels.size(); ++i)
    for (std::size_t j = 0; j < pixels.size(); ++j)
      expected += variance *
                  (i == j ? 1.0 : 0.95 * k(pixels[i].x - pixels[j].x) * k(pixels[i].y - pixels[j].y)) *
                  influence.col(static_cast<Eigen::Index>(i)) *
                  influence.col(static_cast<Eigen::Index>(j)).transpose();
  const Eigen::Matrix<double, 8, 8> covariance =
      ResidualNoise(pixels, kNumUnknowns).covariance_of_sum(influence);
  EXPECT_LT((covariance - expected).norm(), 1e-9 * expected.norm());
}

TEST(ResidualNoise, GivesNoSumANegativeVariance) {
  const std::vector<FittedPixel> pixels = pixels_alike();
  const ResidualNoise noise(pixels, kNumUnknowns);
  for (int first = 0; first <= 16; ++first) {
    const Eigen::Matrix<double, 8, 8> covariance = noise.covariance_of_sum(waves(pixels, first));
    for (int wave = 0; wave < 8; ++wave) EXPECT_GT(covariance(wave, wave), 0.0) << first << ' ' << wave;
  }
}

}  // namespace
}  // namespace apriltrack
