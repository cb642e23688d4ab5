#include "numerics/words.h"

#include <gtest/gtest.h>

namespace apriltrack {
namespace {

TEST(Words, TellNumbersWithoutPowersOfTen) {
  EXPECT_EQ(in_two_digits(0.0214), "0.021");
  EXPECT_EQ(in_two_digits(6.34), "6.3");
  EXPECT_EQ(in_two_digits(27.0), "27");
  EXPECT_EQ(in_two_digits(99.6), "100");
  EXPECT_EQ(in_two_digits(117.4), "117");
  EXPECT_EQ(in_two_digits(-1234.0), "-1234");
}

}  // namespace
}  // namespace apriltrack
