#include "numerics/cauchy_loss.h"

#include <gtest/gtest.h>

namespace apriltrack {
namespace {

TEST(CauchyLoss, IsHalfTheSquaresWhereTheseAreSmall) {
  EXPECT_NEAR(CauchyLoss{8.0}.cost(1e-3), 0.5e-3, 1e-8);
  EXPECT_NEAR(CauchyLoss{8.0}.weight(1e-3), 1.0, 1e-4);
}

TEST(CauchyLoss, GrowsByEqualStepsWhereSquaresGrowByEqualFactors) {
  const CauchyLoss loss{2.0};
  constexpr double kLog10 = 2.302585092994046;
  EXPECT_NEAR(loss.cost(1e9) - loss.cost(1e8), 0.5 * 4.0 * kLog10, 1e-6);
}

TEST(CauchyLoss, HasTheDerivativeOfItsCostAsItsWeight) {
  for (const double scale : {1.0, 3.0, 8.0}) {
    const CauchyLoss loss{scale};
    for (const double squares : {0.1, 8.0, 64.0, 1000.0}) {
      const double step = 1e-4 * squares;
      const double slope = (loss.cost(squares + step) - loss.cost(squares - step)) / (2.0 * step);
      EXPECT_NEAR(loss.weight(squares), 2.0 * slope, 1e-7) << scale << " " << squares;
    }
  }
}

}  // namespace
}  // namespace apriltrack
