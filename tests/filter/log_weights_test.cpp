#include "apriltrack/filter/log_weights.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace apriltrack {
namespace {

constexpr double kNever = -std::numeric_limits<double>::infinity();
const double kNaN = std::nan("");

TEST(LogSumExp, HoldsWhereTheExponentialDoesNot) {
  EXPECT_NEAR(log_sum_exp(std::vector{1000.0, 1000.0, 1000.0}), 1000.0 + std::log(3.0), 1e-12);
  EXPECT_NEAR(log_sum_exp(std::vector{-2000.0, -2000.0 + std::log(3.0)}), -2000.0 + std::log(4.0), 1e-12);
  EXPECT_NEAR(log_sum_exp(std::vector{std::log(0.2), kNever, std::log(0.3), kNaN}), std::log(0.5), 1e-12);
  EXPECT_EQ(log_sum_exp(std::vector<double>()), kNever);
  EXPECT_EQ(log_sum_exp(std::vector{kNever, kNever}), kNever);
}

TEST(NormalizedWeights, AreSharesOfTheLikelihoods) {
  const std::vector<double> weights =
      normalized_weights(std::vector{5000.0, 5000.0 + std::log(2.0), kNever, kNaN, 5000.0});
  const std::vector<double> expected = {0.25, 0.5, 0.0, 0.0, 0.25};
  ASSERT_EQ(weights.size(), expected.size());
  for (std::size_t i = 0; i < weights.size(); ++i) EXPECT_NEAR(weights[i], expected[i], 1e-12) << i;
}

TEST(NormalizedWeights, AreEqualWhereNothingIsKnown) {
  // The author's program gives all to its first particle here, and the cloud collapses onto it.
  for (const std::vector<double>& nothing :
       {std::vector{kNever, kNever, kNever, kNever}, std::vector{kNaN, kNever, kNaN, kNaN}}) {
    for (const double weight : normalized_weights(nothing)) EXPECT_EQ(weight, 0.25);
  }
}

TEST(EffectiveSize, CountsEqualParticles) {
  EXPECT_NEAR(effective_size(std::vector<double>(40, 1.0 / 40.0)), 40.0, 1e-9);
  EXPECT_NEAR(effective_size(std::vector{0.0, 1.0, 0.0}), 1.0, 1e-12);
  EXPECT_NEAR(effective_size(std::vector{0.75, 0.25}), 1.0 / (0.5625 + 0.0625), 1e-12);
}

}  // namespace
}  // namespace apriltrack
