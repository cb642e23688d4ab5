#include "apriltrack/base/normal_table.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace apriltrack {
namespace {

TEST(NormalTable, AgreesWithTheErrorFunctionEverywhere) {
  for (double place = -7.5; place < 7.5; place += 0.00317) {
    const NormalValue value = NormalTable::get().at(place);
    EXPECT_NEAR(value.below, 0.5 * std::erfc(-place / std::numbers::sqrt2), 1e-10) << place;
    EXPECT_NEAR(value.density, std::exp(-0.5 * place * place) / std::sqrt(2.0 * std::numbers::pi), 1e-10)
        << place;
  }
}

TEST(NormalTable, EndsWhereNothingIsLeft) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  EXPECT_NEAR(NormalTable::get().at(std::nextafter(7.0, 0.0)).below, 1.0, 1e-10);
  EXPECT_EQ(NormalTable::get().at(-kFar).below, 0.0);
  EXPECT_EQ(NormalTable::get().at(kFar).below, 1.0);
  EXPECT_EQ(NormalTable::get().at(kFar).density, 0.0);
}

}  // namespace
}  // namespace apriltrack
