#include "least_contrast.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "apriltrack/base/random.h"
#include "apriltrack/detect/detector.h"
#include "apriltrack/tags/tag_family.h"

namespace apriltrack {
namespace {

/// Grey with normal grain.
GrayImage grainy(int width, int height, double level, double sigma, RandomStream& random) {
  GrayImage image(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x)
      image(x, y) =
          static_cast<std::uint8_t>(std::clamp(std::lround(level + sigma * random.normal()), 0L, 255L));
  }
  return image;
}

/// tag36h11/0, upright, of cells of 6 px, black and white `contrast` apart, under the same grain.
GrayImage grainy_tag(double contrast, double sigma, RandomStream& random) {
  constexpr int kSide = 120, kCell_px = 6;
  GrayImage image = grainy(kSide, kSide, 60.0 + contrast, sigma, random);
  const TagPattern pattern = TagFamily::get("tag36h11").pattern(0);
  const double half_px = kCell_px * 4.0;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const double u = (x - 59.5) / half_px, v = (y - 59.5) / half_px;
      if (std::max(std::abs(u), std::abs(v)) > 1.25) continue;
      const double light = 60.0 + contrast * pattern.brightness(u, v) + sigma * random.normal();
      image(x, y) = static_cast<std::uint8_t>(std::clamp(std::lround(light), 0L, 255L));
    }
  }
  return image;
}

TEST(LeastContrast, IsOfTheMarginWhereThereIsNoGrain) {
  RandomStream random(1);
  const GrayImage plain = grainy(96, 96, 100.0, 0.0, random);
  EXPECT_EQ(least_contrast(plain.view(), 5.0), 10);
  EXPECT_EQ(least_contrast(plain.view(), 3.5), 7);
  EXPECT_EQ(least_contrast(plain.view(), 0.0), 5) << "the library's own";
  EXPECT_EQ(least_contrast(plain.view(), 100.0), 10) << "sharpened margins tell little of the contrast";
}

TEST(LeastContrast, GrowsWithTheGrainWithinBounds) {
  // The range of 144 normal numbers is 5.3 sigma in the mean.
  RandomStream random(2);
  const GrayImage fine = grainy(240, 240, 100.0, 2.0, random);
  EXPECT_NEAR(least_contrast(fine.view(), 5.0), 10.0 + 0.5 * 5.3 * 2.0, 1.5);
  const GrayImage coarse = grainy(240, 240, 100.0, 20.0, random);
  EXPECT_EQ(least_contrast(coarse.view(), 5.0), 20);
}

TEST(LeastContrast, OfAnImageWithoutASquareIsThatOfTheMargin) {
  EXPECT_EQ(least_contrast(GrayImage(11, 40).view(), 5.0), 10);
}

TEST(LeastContrast, LosesNoTagThatTheLibrarysOwnFinds) {
  // Down to tags that are hardly there, in an image as it is (a linear response: one search).
  const auto find = [](const GrayImage& image, bool with_the_librarys) {
    Detector detector({.response = ResponseCurve::linear(), .refine_edges = !with_the_librarys});
    return detector.detect(image.view()).size();
  };
  int num_found = 0, num_by_library = 0;
  for (const double contrast : {10.0, 12.0, 15.0, 20.0, 30.0, 60.0}) {
    for (const double sigma : {0.0, 1.0, 2.0, 3.0, 4.0}) {
      for (std::uint64_t seed = 0; seed < 4; ++seed) {
        RandomStream random(seed, 77);
        const GrayImage image = grainy_tag(contrast, sigma, random);
        const std::size_t found = find(image, false), by_library = find(image, true);
        EXPECT_GE(found, by_library) << contrast << " grey levels, grain " << sigma << ", seed " << seed;
        num_found += static_cast<int>(found);
        num_by_library += static_cast<int>(by_library);
      }
    }
  }
  EXPECT_GT(num_by_library, 40);
  EXPECT_LT(num_by_library, 120) << "some are too faint for either";
}

}  // namespace
}  // namespace apriltrack
