#include "apriltrack/base/geman_mcclure.h"

#include <gtest/gtest.h>

namespace apriltrack {
namespace {

TEST(GemanMcClure, IsTheSquareOfWhatIsNearAndBoundedFarOff) {
  const GemanMcClure error(2.5);
  EXPECT_NEAR(error.penalty(1e-8), 1e-8, 1e-16);
  EXPECT_DOUBLE_EQ(error.penalty(2.5 * 2.5), 0.5 * 2.5 * 2.5);  // half of the bound at the reach
  EXPECT_NEAR(error.penalty(1e12), 2.5 * 2.5, 1e-9);
  EXPECT_EQ(error.weight(0.0), 1.0);
  EXPECT_DOUBLE_EQ(error.weight(2.5 * 2.5), 0.25);
}

TEST(GemanMcClure, WeighsByTheSlopeOfThePenalty) {
  for (const double reach : {0.5, 3.0}) {
    const GemanMcClure error(reach);
    for (const double r2 : {0.1, 1.0, 7.0, 60.0}) {
      const double step = 1e-4 * r2;
      const double slope = (error.penalty(r2 + step) - error.penalty(r2 - step)) / (2.0 * step);
      EXPECT_NEAR(error.weight(r2), slope, 1e-6 * slope) << r2;
    }
  }
}

}  // namespace
}  // namespace apriltrack
