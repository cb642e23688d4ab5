#include "apriltrack/photometric/pattern_texture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "apriltrack/base/random.h"

namespace apriltrack {
namespace {

struct Truth {
  double light = 0.0, presence = 0.0;
};

/// Whether the family says what is printed there.
bool is_printed(const TagPattern& pattern, double u, double v) {
  const double extent = pattern.half_extent();
  if (!(std::max(std::abs(u), std::abs(v)) < extent)) return false;
  const int column = static_cast<int>((u + extent) / pattern.cell_size());
  const int row = static_cast<int>((v + extent) / pattern.cell_size());
  const int last = pattern.cells().width() - 1;
  return !std::isnan(pattern.cells()(std::min(column, last), std::min(row, last)));
}

/// The Gaussian blur of a pattern at one point by adding up small squares.
Truth blurred(const TagPattern& pattern, double u, double v, double sigma_u, double sigma_v) {
  constexpr int kSteps = 400;  // of a sixteenth of a cell and less
  constexpr double kReach = 5.0;
  Truth sum;
  double total = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    const double a = kReach * (2.0 * (i + 0.5) / kSteps - 1.0);
    for (int k = 0; k < kSteps; ++k) {
      const double b = kReach * (2.0 * (k + 0.5) / kSteps - 1.0);
      const double weight = std::exp(-0.5 * (a * a + b * b));
      total += weight;
      const double x = u + a * sigma_u, y = v + b * sigma_v;
      if (!is_printed(pattern, x, y)) continue;
      sum.light += weight * pattern.brightness(x, y);
      sum.presence += weight;
    }
  }
  return {sum.light / total, sum.presence / total};
}

TEST(PatternTexture, IsTheGaussianBlurOfThePrintedCells) {
  // A texel's interpolation and the sum's squares each cost up to 0.01.
  constexpr double kTolerance = 0.02;
  RandomStream random(1);
  int num_beyond = 0, num_gaps = 0;
  for (const char* name : {"tag36h11", "tagCircle21h7", "tagCustom48h12"}) {
    const TagPattern pattern = TagFamily::get(name).pattern(7);
    const double cell = pattern.cell_size();
    for (const auto& [sigma_u, sigma_v] : {std::pair(0.15, 0.15), std::pair(0.4, 1.3), std::pair(2.5, 0.3)}) {
      const PatternTexture texture(pattern, sigma_u * cell, sigma_v * cell);
      for (int i = 0; i < 40; ++i) {
        // Every eighth in the middle.
        const double reach = i % 8 == 0 ? cell : pattern.half_extent() + 2.0 * cell;
        const double u = random.uniform(-reach, reach), v = random.uniform(-reach, reach);
        const Truth expected = blurred(pattern, u, v, sigma_u * cell, sigma_v * cell);
        const PatternSample found = texture.sample(static_cast<float>(u), static_cast<float>(v));
        EXPECT_NEAR(found.light, expected.light, kTolerance)
            << name << " " << sigma_u << " " << u << " " << v;
        EXPECT_NEAR(found.presence, expected.presence, kTolerance);
        num_beyond += expected.presence < 0.5 ? 1 : 0;
        const bool is_in_square = std::max(std::abs(u), std::abs(v)) < pattern.half_extent() - 0.5 * cell;
        num_gaps += is_in_square && expected.presence < 0.5 ? 1 : 0;
      }
    }
  }
  EXPECT_GT(num_beyond, 20);
  EXPECT_GT(num_gaps, 8);  // cells left to the printer
}

TEST(PatternTexture, GradientIsThatOfItsSamples) {
  const TagPattern pattern = TagFamily::get("tag36h11").pattern(3);
  const PatternTexture texture(pattern, 0.12, 0.2);
  RandomStream random(2);
  constexpr float kStep = 1e-3F;  // a twentieth of a texel
  int num_steep = 0;
  double squared_error = 0.0, squared = 0.0;
  for (int i = 0; i < 500; ++i) {
    const auto u = static_cast<float>(random.uniform(-1.2, 1.2));
    const auto v = static_cast<float>(random.uniform(-1.2, 1.2));
    PatternGradient gradient;
    const PatternSample at = texture.sample(u, v, gradient);
    EXPECT_EQ(at.light, texture.sample(u, v).light);
    const auto slope = [&](float du, float dv) {
      const PatternSample a = texture.sample(u - du, v - dv), b = texture.sample(u + du, v + dv);
      return std::pair((b.light - a.light) / (2.0F * kStep), (b.presence - a.presence) / (2.0F * kStep));
    };
    const auto [light_u, presence_u] = slope(kStep, 0.0F);
    const auto [light_v, presence_v] = slope(0.0F, kStep);
    for (const auto& [a, b] :
         {std::pair(gradient.light_u, light_u), std::pair(gradient.light_v, light_v),
          std::pair(gradient.presence_u, presence_u), std::pair(gradient.presence_v, presence_v)}) {
      squared_error += (a - b) * (a - b);
      squared += b * b;
      num_steep += std::abs(b) > 0.5F ? 1 : 0;
    }
  }
  EXPECT_GT(num_steep, 300);
  EXPECT_LT(std::sqrt(squared_error / squared), 0.03);  // a few steps cross from texel to texel
}

}  // namespace
}  // namespace apriltrack
