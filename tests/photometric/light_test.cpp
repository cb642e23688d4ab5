#include "apriltrack/photometric/light.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "allocation_limit.h"
#include "apriltrack/base/random.h"

namespace apriltrack {
namespace {

constexpr int kLevels = 3;

GrayImage noise(int width, int height, std::uint64_t seed) {
  RandomStream random(seed);
  GrayImage image(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) image(x, y) = static_cast<std::uint8_t>(random.uniform(0.0, 255.9));
  }
  return image;
}

void expect_same(const LightPyramid& a, const LightPyramid& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t level = 0; level < a.size(); ++level) {
    ASSERT_EQ(a[level].width(), b[level].width());
    ASSERT_EQ(a[level].height(), b[level].height());
    for (int y = 0; y < a[level].height(); ++y)
      EXPECT_TRUE(std::equal(a[level].row(y), a[level].row(y) + a[level].width(), b[level].row(y)));
  }
}

TEST(FillLightPyramid, IsThePyramidOfTheLightWhateverWasThereBefore) {
  const ResponseCurve response = ResponseCurve::srgb();
  LightPyramid pyramid;
  std::uint64_t seed = 1;
  for (const int width : {62, 62, 35, 80}) {  // rows and columns left out, smaller, larger
    const GrayImage image = noise(width, 41, seed++);
    fill_light_pyramid(image.view(), response, kLevels, pyramid);
    expect_same(pyramid, light_pyramid(to_linear_light(image.view(), response), kLevels));
  }
}

TEST(FillLightPyramid, TakesNoMemoryForAnotherImageOfTheSize) {
  const GrayImage first = noise(64, 48, 1), second = noise(64, 48, 2);
  const ResponseCurve response = ResponseCurve::linear();
  LightPyramid pyramid;
  fill_light_pyramid(first.view(), response, kLevels, pyramid);
  const test::AllocationLimit limit(64);  // bytes: less than a row of the coarsest level would take
  fill_light_pyramid(second.view(), response, kLevels, pyramid);
}

}  // namespace
}  // namespace apriltrack
