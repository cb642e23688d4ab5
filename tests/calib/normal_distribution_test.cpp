#include "numerics/normal_distribution.h"

#include <gtest/gtest.h>

#include <utility>

namespace apriltrack {
namespace {

TEST(StudentPlace, IsAsUnlikelyAsTwoSigmas) {
  // By integrating Student's density: beyond these lie 2.275 %.
  const std::pair<double, double> places[] = {
      {2, 4.5265}, {3, 3.3068}, {4, 2.8693}, {9, 2.3198}, {29, 2.0900}};
  for (const auto& [degrees, place] : places)
    EXPECT_NEAR(student_place(2.0, degrees) / place, 1.0, degrees < 4 ? 0.011 : 0.004) << degrees;
}

}  // namespace
}  // namespace apriltrack
