#include "apriltrack/base/random.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "apriltrack/base/parallel.h"

namespace apriltrack {
namespace {

constexpr int kNumSamples = 100'000;

/// Largest distance between the samples' distribution and the one given (Kolmogorov and Smirnov). For 100000
/// samples of the right one it exceeds 0.0062 once in a thousand.
template <class Distribution>
double kolmogorov_distance(std::vector<double> samples, const Distribution& distribution) {
  std::sort(samples.begin(), samples.end());
  double distance = 0.0;
  const auto n = static_cast<double>(samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double expected = distribution(samples[i]);
    distance = std::max({distance, std::abs(expected - static_cast<double>(i) / n),
                         std::abs(expected - static_cast<double>(i + 1) / n)});
  }
  return distance;
}
constexpr double kMaxDistance = 0.0062;

TEST(RandomStream, UniformIsUniform) {
  RandomStream random(1);
  std::vector<double> samples(kNumSamples);
  for (double& sample : samples) sample = random.uniform();
  EXPECT_LT(kolmogorov_distance(samples, [](double x) { return x; }), kMaxDistance);
  EXPECT_GE(*std::min_element(samples.begin(), samples.end()), 0.0);
  EXPECT_LT(*std::max_element(samples.begin(), samples.end()), 1.0);
}

TEST(RandomStream, UniformKeepsItsRange) {
  RandomStream random(2);
  std::vector<double> samples(kNumSamples);
  for (double& sample : samples) sample = random.uniform(-3.0, 5.0);
  EXPECT_LT(kolmogorov_distance(samples, [](double x) { return (x + 3.0) / 8.0; }), kMaxDistance);
}

TEST(RandomStream, NormalIsNormal) {
  RandomStream random(3);
  std::vector<double> samples(kNumSamples);
  for (double& sample : samples) sample = random.normal();
  EXPECT_LT(kolmogorov_distance(samples, [](double x) { return 0.5 * std::erfc(-x / std::sqrt(2.0)); }),
            kMaxDistance);
  EXPECT_TRUE(std::all_of(samples.begin(), samples.end(), [](double x) { return std::isfinite(x); }));
  EXPECT_GT(*std::max_element(samples.begin(), samples.end()), 3.5) << "tails are not cut";
}

TEST(RandomStream, FirstNumbersOfNeighbouringStreamsAreIndependent) {
  // A particle filter takes a few numbers from each of many streams: they must look as random as one long
  // stream.
  std::vector<double> samples;
  double sum_of_products = 0.0;
  double before = 0.0;
  for (int particle = 0; particle < kNumSamples; ++particle) {
    RandomStream random(7, 3, static_cast<std::uint64_t>(particle));
    samples.push_back(random.uniform());
    sum_of_products += (samples.back() - 0.5) * (before - 0.5);
    before = samples.back();
  }
  EXPECT_LT(kolmogorov_distance(samples, [](double x) { return x; }), kMaxDistance);
  // Correlation of neighbours: standard deviation 1 / sqrt(n) = 0.0032.
  EXPECT_LT(std::abs(sum_of_products / kNumSamples * 12.0), 4 * 0.0032);
}

TEST(RandomStream, TheSameKeyGivesTheSameNumbersAndAnotherKeyOthers) {
  RandomStream a(1, 2, 3);
  RandomStream b(1, 2, 3);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(a(), b());
  std::set<std::uint64_t> firsts;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    for (std::uint64_t key_1 = 0; key_1 < 10; ++key_1) {
      for (std::uint64_t key_2 = 0; key_2 < 10; ++key_2) firsts.insert(RandomStream(seed, key_1, key_2)());
    }
  }
  EXPECT_EQ(firsts.size(), 1000U) << "(1, 2, 3) and (3, 2, 1) are different streams";
}

TEST(RandomStream, DoesNotDependOnTheNumberOfThreads) {
  const auto draw = [](int num_threads) {
    std::vector<double> values(500);
    parallel_for(num_threads)(values.size(), [&](std::size_t i) {
      RandomStream random(9, 0, i);
      for (int k = 0; k < 5; ++k) values[i] += random.normal();
    });
    return values;
  };
  const auto serial = draw(1);
  EXPECT_EQ(draw(2), serial);
  EXPECT_EQ(draw(7), serial);
}

}  // namespace
}  // namespace apriltrack
