#include "edge_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "apriltrack/base/random.h"

namespace apriltrack {
namespace {

constexpr double kNoise = 0.01;  // of a contrast of 0.6

/// Black border and white paper, then a black cell 6 px further in; blurred by 1.4 px, along a bent line.
struct BlurredEdge {
  std::vector<EdgeSample> samples;
  std::vector<EdgeProfile> profiles;

  explicit BlurredEdge(double offset_px, double slope_px, double bend_px) {
    RandomStream random(1);
    for (std::size_t column = 0; column < 25; ++column) {
      const double along = -0.96 + 0.08 * static_cast<double>(column);
      EdgeProfile& profile = profiles.emplace_back();
      if (column % 2 == 0) profile = {1.0, 2, {-6.0, 0.0}, {-1.0, 1.0}};
      if (column % 2 == 1) profile = {0.0, 1, {0.0}, {1.0}};
      const double edge = offset_px + slope_px * along + bend_px * (along * along - 1.0 / 3.0);
      for (double across = -9.0; across <= 5.0; across += 0.75) {
        const double level = level_at(profile, across - edge);
        samples.push_back(
            {along, across, 0.2 + (0.6 + 0.05 * along) * level + kNoise * random.normal(), column});
      }
    }
  }

  static double level_at(const EdgeProfile& profile, double across) {
    double level = profile.innermost_level;
    for (std::size_t i = 0; i < static_cast<std::size_t>(profile.num_changes); ++i) {
      const double z = (across - profile.position_px[i]) / 1.4;
      level += profile.height[i] * 0.5 * std::erfc(-z / std::numbers::sqrt2);
    }
    return level;
  }
};

TEST(EdgeFit, FindsABentLine) {
  const BlurredEdge blurred(0.4, -0.3, 0.15);
  const auto edge = fit_edge(blurred.samples, blurred.profiles, {.bend_prior_px = 1.0});
  ASSERT_TRUE(edge);
  EXPECT_NEAR(edge->offset, 0.4, 0.02);
  EXPECT_NEAR(edge->slope, -0.3, 0.03);
  EXPECT_NEAR(edge->bend, 0.15, 0.05);
  EXPECT_NEAR(edge->sigma_px, 1.4, 0.05);
  EXPECT_NEAR(edge->outer_tilt, 0.05, 0.02);
}

TEST(EdgeFit, EndsAtTheSameLineWhereverItBegins) {
  constexpr double kSettled_px = 4e-3;  // two steps of what ends a fit
  const BlurredEdge before(0.4, -0.3, 0.15), now(-0.1, 0.02, 0.15);
  EdgeFitOptions options{.bend_prior_px = 1.0};
  const auto cold = fit_edge(now.samples, now.profiles, options);
  options.before = fit_edge(before.samples, before.profiles, options);
  ASSERT_TRUE(options.before);
  const auto warm = fit_edge(now.samples, now.profiles, options);
  ASSERT_TRUE(cold && warm);
  EXPECT_NEAR(warm->offset, cold->offset, kSettled_px);
  EXPECT_NEAR(warm->slope, cold->slope, kSettled_px);
  EXPECT_NEAR(warm->bend, cold->bend, kSettled_px);
  EXPECT_NEAR(warm->sigma_px, cold->sigma_px, kSettled_px);
}

}  // namespace
}  // namespace apriltrack
