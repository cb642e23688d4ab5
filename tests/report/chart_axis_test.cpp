#include "chart_axis.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <set>

namespace apriltrack {
namespace {

using testing::ElementsAre;

std::vector<std::string> labels(const AxisRange& range, int max_labels) {
  std::vector<std::string> out;
  for (const Tick& tick : ticks_for(range, max_labels))
    if (!tick.label.empty()) out.push_back(tick.label);
  return out;
}

TEST(ChartAxis, LinearLabelsAreRoundNumbers) {
  EXPECT_THAT(labels({0.0, 20.0, false}, 6), ElementsAre("0", "5", "10", "15", "20"));
  EXPECT_THAT(labels({-0.31, 0.33, false}, 8), ElementsAre("-0.3", "-0.2", "-0.1", "0", "0.1", "0.2", "0.3"));
  EXPECT_THAT(labels({0.0, 3e-6, false}, 4), ElementsAre("0", "1e-6", "2e-6", "3e-6"));
  EXPECT_THAT(labels({0.0, 4e6, false}, 5), ElementsAre("0", "1e6", "2e6", "3e6", "4e6"));
  EXPECT_THAT(labels({1403636579.2, 1403636580.3, false}, 3), ElementsAre("1403636579.5", "1403636580.0"));
}

TEST(ChartAxis, LogarithmicLabelsAreDecades) {
  EXPECT_THAT(labels({0.01, 100.0, true}, 8), ElementsAre("0.01", "0.1", "1", "10", "100"));
  EXPECT_THAT(labels({0.5, 20.0, true}, 8), ElementsAre("0.5", "1", "2", "5", "10", "20"));
  EXPECT_THAT(labels({3.0, 8.0, true}, 8), ElementsAre("3", "4", "5", "6", "7", "8"));
  EXPECT_THAT(labels({1e-6, 1e6, true}, 5), ElementsAre("1e-6", "0.001", "1", "1000", "1e6"));
  // Between 1 and 10: 2 to 9 in the minor grid.
  EXPECT_EQ(ticks_for({0.1, 1000.0, true}, 8).size(), 4u * 9u + 1u);
}

/// Whether ticks are whole multiples of 1, 2 or 5 x 10^n apart, judged with a decimal printer.
bool is_round(double step) {
  char digits[32];
  std::snprintf(digits, sizeof digits, "%.9e", step);
  const std::string mantissa(digits, 11);
  return mantissa == "1.000000000" || mantissa == "2.000000000" || mantissa == "5.000000000";
}

TEST(ChartAxis, AnyLinearRangeGetsFewRoundDistinctTicks) {
  std::mt19937 random(20);
  std::uniform_real_distribution<double> exponent(-7.0, 7.0);
  std::uniform_real_distribution<double> offset(-40.0, 40.0);
  for (int i = 0; i < 2000; ++i) {
    const double length = std::pow(10.0, exponent(random));
    const double low = offset(random) * length;
    const AxisRange range{low, low + length, false};
    const auto ticks = ticks_for(range, 8);
    ASSERT_GE(ticks.size(), 3u) << low << " " << length;
    ASSERT_LE(ticks.size(), 8u) << low << " " << length;
    const double step = ticks[1].value - ticks[0].value;
    EXPECT_TRUE(is_round(step)) << step;
    std::set<std::string> distinct;
    for (const Tick& tick : ticks) {
      EXPECT_GE(range.fraction(tick.value), -1e-9);
      EXPECT_LE(range.fraction(tick.value), 1.0 + 1e-9);
      EXPECT_NEAR(std::stod(tick.label), tick.value, 1e-6 * step) << "the label says where the tick is";
      distinct.insert(tick.label);
    }
    EXPECT_EQ(distinct.size(), ticks.size());
  }
}

TEST(ChartAxis, OpenEndsHoldAllValues) {
  const AxisRange near_zero = range_for({}, {0.3, 9.0, 4.0});
  EXPECT_EQ(near_zero.low, 0.0);
  EXPECT_GT(near_zero.high, 9.0);
  EXPECT_LT(near_zero.high, 10.0);
  const AxisRange far = range_for({}, {100.0, 104.0});
  EXPECT_NEAR(far.low, 99.9, 0.1);
  const AxisRange decades = range_for({"", true, {}, {}, false}, {0.03, 700.0, 0.0, -4.0});
  EXPECT_DOUBLE_EQ(decades.low, 0.02);
  EXPECT_DOUBLE_EQ(decades.high, 1000.0);
}

TEST(ChartAxis, HasALengthWhateverItHolds) {
  const double infinity = std::numeric_limits<double>::infinity();
  const std::vector<std::vector<double>> cases = {
      {}, {0.0}, {-7.0}, {1e300}, {infinity}, {1.0, 1.0 + 1e-15}, {-1e9, -1e9 + 1e-7}};
  for (const auto& values : cases) {
    for (const bool is_logarithmic : {false, true}) {
      for (const ChartAxis& axis :
           {ChartAxis{"", is_logarithmic, {}, {}, false}, ChartAxis{"", is_logarithmic, 1e3, {}, false},
            ChartAxis{"", is_logarithmic, {}, 1e-3, false}}) {
        const AxisRange range = range_for(axis, values);
        EXPECT_LT(range.low, range.high);
        EXPECT_EQ(range.low, axis.low.value_or(range.low));
        EXPECT_EQ(range.high, axis.high.value_or(range.high));
        EXPECT_LT(ticks_for(range, 8).size(), 100u);
      }
    }
  }
}

}  // namespace
}  // namespace apriltrack
