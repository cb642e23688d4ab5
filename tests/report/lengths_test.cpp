// Lengths for people.

#include "apriltrack/report/lengths.h"

#include <gtest/gtest.h>

namespace apriltrack {
namespace {

TEST(Lengths, AreMetresFromAMetreOnAndMillimetresBelow) {
  EXPECT_EQ(length_in_words(1.2340), "1.234 m");
  EXPECT_EQ(length_in_words(-2.0), "-2 m");
  EXPECT_EQ(length_in_words(0.162), "162 mm");
  EXPECT_EQ(length_in_words(0.001478), "1.48 mm");
  EXPECT_EQ(length_in_words(8.12e-6), "0.00812 mm");
  EXPECT_EQ(length_in_words(0.0), "0 mm");
}

TEST(Lengths, AChartsUnitIsThatOfItsLongest) {
  EXPECT_STREQ(unit_for(0.99).name, "mm");
  EXPECT_DOUBLE_EQ(unit_for(0.99).per_m, 1e3);
  EXPECT_STREQ(unit_for(1.0).name, "m");
}

}  // namespace
}  // namespace apriltrack
