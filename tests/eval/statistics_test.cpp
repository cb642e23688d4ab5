#include "apriltrack/eval/statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "apriltrack/base/check.h"

namespace apriltrack {
namespace {

TEST(Statistics, MediansOfOddAndEvenCounts) {
  EXPECT_EQ(median(std::vector<double>{5.0, 1.0, 3.0}), 3.0);
  EXPECT_EQ(median(std::vector<double>{4.0, 1.0, 3.0, 2.0}), 2.5);
}

TEST(Statistics, PercentilesAreLinearInRank) {
  // numpy.percentile([1, 2, 3, 4, 10], q) for q = 0, 25, 95, 99, 100.
  const std::vector<double> values = {10.0, 3.0, 1.0, 4.0, 2.0};
  EXPECT_EQ(percentile(values, 0.0), 1.0);
  EXPECT_EQ(percentile(values, 0.25), 2.0);
  EXPECT_NEAR(percentile(values, 0.95), 8.8, 1e-12);
  EXPECT_NEAR(percentile(values, 0.99), 9.76, 1e-12);
  EXPECT_EQ(percentile(values, 1.0), 10.0);
}

TEST(Statistics, RefusesPercentsForFractions) {
  EXPECT_THROW(percentile(std::vector<double>{1.0}, 50.0), MisuseError);
}

TEST(Statistics, RootMeanSquareAndMean) {
  const std::vector<double> values = {3.0, -4.0};
  EXPECT_DOUBLE_EQ(root_mean_square(values), std::sqrt(12.5));
  EXPECT_DOUBLE_EQ(mean(values), -0.5);
}

TEST(Statistics, NothingHasNoStatistics) {
  EXPECT_TRUE(std::isnan(median({})));
  EXPECT_TRUE(std::isnan(mean({})));
  EXPECT_TRUE(std::isnan(root_mean_square({})));
  EXPECT_TRUE(std::isnan(percentile({}, 0.5)));
}

// Published by Python's documentation of round() and IEEE 754: ties in binary go to even; 2.675 lies below
// its name.
TEST(Statistics, RoundsLikePythonsRound) {
  EXPECT_EQ(round_to_decimals(0.125, 2), 0.12);
  EXPECT_EQ(round_to_decimals(0.375, 2), 0.38);
  EXPECT_EQ(round_to_decimals(0.03125, 4), 0.0312);
  EXPECT_EQ(round_to_decimals(2.675, 2), 2.67);
  EXPECT_EQ(round_to_decimals(2.5, 0), 2.0);
  EXPECT_EQ(round_to_decimals(-0.125, 2), -0.12);
  EXPECT_EQ(round_to_decimals(1e300, 3), 1e300);
  EXPECT_TRUE(std::isnan(round_to_decimals(std::nan(""), 3)));
}

}  // namespace
}  // namespace apriltrack
