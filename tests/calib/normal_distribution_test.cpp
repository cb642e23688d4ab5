#include "normal_distribution.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace apriltrack {
namespace {

TEST(NormalDistribution, AgreesWithTheErrorFunctionEverywhere) {
  for (double place = -7.5; place < 7.5; place += 0.00317) {
    const NormalValue value = NormalTable::get().at(place);
    EXPECT_NEAR(value.below, 0.5 * std::erfc(-place / std::numbers::sqrt2), 1e-10) << place;
    EXPECT_NEAR(value.density, std::exp(-0.5 * place * place) / std::sqrt(2.0 * std::numbers::pi), 1e-10)
        << place;
  }
}

TEST(NormalDistribution, EndsWhereNothingIsLeft) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  EXPECT_NEAR(NormalTable::get().at(std::nextafter(7.0, 0.0)).below, 1.0, 1e-10);
  EXPECT_EQ(NormalTable::get().at(-kFar).below, 0.0);
  EXPECT_EQ(NormalTable::get().at(kFar).below, 1.0);
  EXPECT_EQ(NormalTable::get().at(kFar).density, 0.0);
}

TEST(StudentPlace, IsAsUnlikelyAsTwoSigmas) {
  // By integrating Student's density: beyond these lie 2.275 %.
  const std::pair<double, double> places[] = {
      {2, 4.5265}, {3, 3.3068}, {4, 2.8693}, {9, 2.3198}, {29, 2.0900}};
  for (const auto& [degrees, place] : places)
    EXPECT_NEAR(student_place(2.0, degrees) / place, 1.0, degrees < 4 ? 0.011 : 0.004) << degrees;
}

}  // namespace
}  // namespace apriltrack
