#include "numerics/upper_median.h"

#include <gtest/gtest.h>

namespace apriltrack {
namespace {

TEST(UpperMedian, IsTheMiddleOneAndTheUpperOfTwo) {
  EXPECT_EQ(upper_median({7.0}), 7.0);
  EXPECT_EQ(upper_median({5.0, 1.0, 9.0}), 5.0);
  EXPECT_EQ(upper_median({9.0, 2.0, 1.0, 4.0}), 4.0);
}

}  // namespace
}  // namespace apriltrack
