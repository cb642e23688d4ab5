#include "apriltrack/filter/resample.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <vector>

#include "apriltrack/base/check.h"
#include "apriltrack/filter/log_weights.h"

namespace apriltrack {
namespace {

std::vector<double> random_weights(RandomStream& random, std::size_t size) {
  std::vector<double> logs(size);
  for (double& value : logs) value = 2.0 * random.normal();
  return normalized_weights(logs);
}

std::vector<int> counts_of(const std::vector<std::size_t>& indices, std::size_t size) {
  std::vector<int> counts(size, 0);
  for (const std::size_t index : indices) ++counts.at(index);
  return counts;
}

TEST(Resample, IsRightInTheMean) {
  RandomStream random(2);
  const std::vector<double> weights = random_weights(random, 12);
  constexpr int kRuns = 4000, kCount = 50;
  std::vector<double> mean(weights.size(), 0.0);
  for (int run = 0; run < kRuns; ++run) {
    const std::vector<int> counts = counts_of(resample_multinomial(weights, kCount, random), weights.size());
    for (std::size_t i = 0; i < counts.size(); ++i) mean[i] += static_cast<double>(counts[i]) / kRuns;
  }
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const double sigma = std::sqrt(kCount * weights[i] * (1.0 - weights[i]) / kRuns);
    EXPECT_NEAR(mean[i], kCount * weights[i], 5.0 * sigma) << i;
  }
}

TEST(ResampleMultinomial, VariesAsIndependentDrawsDo) {
  RandomStream random(3);
  const std::vector<double> weights = {0.1, 0.6, 0.3};
  constexpr int kRuns = 5000, kCount = 40;
  double variance = 0.0;
  for (int run = 0; run < kRuns; ++run) {
    const auto indices = resample_multinomial(weights, kCount, random);
    EXPECT_TRUE(std::is_sorted(indices.begin(), indices.end()));
    const double off = counts_of(indices, 3)[1] - 0.6 * kCount;
    variance += off * off / kRuns;
  }
  EXPECT_NEAR(variance, kCount * 0.6 * 0.4, 0.08 * kCount * 0.24);  // 5000 runs know it to 2 %
}

TEST(Resample, LeavesOutWhatHasNoWeight) {
  RandomStream random(4);
  // The sum falls short of 1 by rounding and more: the last particles must not gain by it.
  const std::vector<double> weights = {0.0, 0.4, 0.0, 0.599, 0.0, 0.0};
  int num_drawn = 0;
  for (int run = 0; run < 200; ++run) {
    for (const std::size_t index : resample_multinomial(weights, 64, random)) {
      EXPECT_TRUE(index == 1 || index == 3) << index;
      ++num_drawn;
    }
  }
  EXPECT_EQ(num_drawn, 200 * 64);
  EXPECT_THROW(resample_multinomial({}, 5, random), MisuseError);
}

/// One step of the Kalman filter of x' = 0.9 x + N(0, 0.5), y = x + N(0, 0.3): truth for the particles.
struct Kalman {
  double mean = 0.0, variance = 1.0, log_evidence = 0.0;

  void step(double y) {
    mean *= 0.9;
    variance = 0.81 * variance + 0.5;
    const double total = variance + 0.3;
    log_evidence -= 0.5 * ((y - mean) * (y - mean) / total + std::log(2.0 * std::numbers::pi * total));
    const double gain = variance / total;
    mean += gain * (y - mean);
    variance *= 1.0 - gain;
  }
};

TEST(Resample, MakesAFilterThatAgreesWithKalmans) {
  constexpr std::size_t kCount = 20'000;
  RandomStream random(5);
  Kalman truth;
  double x = random.normal(), log_evidence = 0.0;
  std::vector<double> particles(kCount), logs(kCount);
  for (double& particle : particles) particle = random.normal();
  for (int step = 0; step < 25; ++step) {
    x = 0.9 * x + std::sqrt(0.5) * random.normal();
    const double y = x + std::sqrt(0.3) * random.normal();
    truth.step(y);
    for (std::size_t i = 0; i < kCount; ++i) {
      particles[i] = 0.9 * particles[i] + std::sqrt(0.5) * random.normal();
      const double off = y - particles[i];
      logs[i] = -0.5 * (off * off / 0.3 + std::log(2.0 * std::numbers::pi * 0.3));
    }
    log_evidence += log_sum_exp(logs) - std::log(static_cast<double>(kCount));
    const std::vector<double> weights = normalized_weights(logs);
    const double mean = std::inner_product(weights.begin(), weights.end(), particles.begin(), 0.0);
    double variance = 0.0;
    for (std::size_t i = 0; i < kCount; ++i)
      variance += weights[i] * (particles[i] - mean) * (particles[i] - mean);
    // Six standard errors of what the weighted cloud is worth.
    EXPECT_NEAR(mean, truth.mean, 6.0 * std::sqrt(truth.variance / effective_size(weights))) << step;
    EXPECT_NEAR(variance, truth.variance, 0.1 * truth.variance) << step;
    std::vector<double> next;
    for (const std::size_t index : resample_multinomial(weights, kCount, random))
      next.push_back(particles[index]);
    particles = std::move(next);
  }
  EXPECT_NEAR(log_evidence, truth.log_evidence, 0.2);  // 25 steps, each known to about 1 %
}

}  // namespace
}  // namespace apriltrack
