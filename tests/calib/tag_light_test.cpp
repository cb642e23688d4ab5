#include "pictures/tag_light.h"

#include <gtest/gtest.h>

#include <cmath>

#include "apriltrack/base/random.h"

namespace apriltrack {
namespace {

constexpr double kHalfExtent = 1.25;
constexpr int kCells = 10;

double lamp(double u, double v) {
  return 1.0 + 0.3 * std::exp(-4.0 * ((u - 0.4) * (u - 0.4) + v * v)) - 0.1 * u;
}

/// White and black cells by turns, seen with noise, again and again.
TagLight learned(int rounds) {
  TagLight light(kHalfExtent, kCells);
  RandomStream random(3);
  for (int round = 0; round < rounds; ++round) {
    TagLight::Sums sums(light);
    for (int i = 0; i < 4000; ++i) {
      const double u = kHalfExtent * (2.0 * random.uniform() - 1.0),
                   v = kHalfExtent * (2.0 * random.uniform() - 1.0);
      const int cell = static_cast<int>((u + 2.0) / 0.25) + static_cast<int>((v + 2.0) / 0.25);
      const double white = cell % 2 == 0 ? 0.8 : 0.0;
      const double residual = white * (lamp(u, v) - light.factor(u, v)) + 0.01 * random.normal();
      sums.add(light, u, v, white, residual, 1e4);
    }
    light.update(sums);
  }
  return light;
}

TEST(TagLight, IsEvenBeforeAnythingIsSeen) {
  TagLight light(kHalfExtent, kCells);
  EXPECT_EQ(light.factor(0.3, -1.1), 1.0);
  light.update(TagLight::Sums(light));
  EXPECT_EQ(light.factor(0.3, -1.1), 1.0);
}

TEST(TagLight, IsLearnedFromTheWhite) {
  const TagLight light = learned(12);
  for (double u = -1.0; u <= 1.0; u += 0.125) {
    for (double v = -1.0; v <= 1.0; v += 0.125)
      EXPECT_NEAR(light.factor(u, v), lamp(u, v), 0.03) << u << ' ' << v;
  }
}

TEST(TagLight, FollowsItsNeighboursWhereNoWhiteIs) {
  TagLight light(kHalfExtent, kCells);
  for (int round = 0; round < 12; ++round) {
    TagLight::Sums sums(light);
    for (double u = -1.2; u < -0.6; u += 0.02) {
      for (double v = -1.2; v < 1.2; v += 0.02) sums.add(light, u, v, 1.0, 1.2 - light.factor(u, v), 100.0);
    }
    light.update(sums);
  }
  EXPECT_NEAR(light.factor(-0.9, 0.0), 1.2, 0.01);
  EXPECT_GT(light.factor(-0.5, 0.0), 1.1);
  EXPECT_LT(light.factor(1.2, 0.0), 1.12);  // far off, it fades
  EXPECT_GE(light.factor(1.2, 0.0), 1.0);
}

}  // namespace
}  // namespace apriltrack
