#include "apriltrack/sim/image_formation.h"

#include <gtest/gtest.h>

#include <cmath>

#include "apriltrack/base/check.h"

namespace apriltrack {
namespace {

TEST(Vignetting, DarkensTheCornersBySoMuch) {
  Image<float> light(101, 81, 1.0F);
  expose_sensor(light, {.vignetting = 0.24, .sensor_gain = 0.5});
  EXPECT_NEAR(light(50, 40), 0.5, 1e-6);
  EXPECT_NEAR(light(0, 0), 0.5 * 0.76, 1e-6);
  EXPECT_NEAR(light(100, 80), 0.5 * 0.76, 1e-6);
}

double srgb_code(double light) {  // IEC 61966-2-1
  return 255.0 * (light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1.0 / 2.4) - 0.055);
}

TEST(Develop, FollowsTheResponseWithoutNoise) {
  Image<float> light(1001, 1);
  for (int i = 0; i <= 1000; ++i) light(i, 0) = static_cast<float>(i) / 1000.0F;
  const ImageFormation silent{.noise = 0.0};
  const GrayImage srgb = develop(light, ResponseCurve::srgb(), silent, 1, 0);
  const GrayImage linear = develop(light, ResponseCurve::linear(), silent, 1, 0);
  for (int i = 0; i <= 1000; ++i) {
    EXPECT_NEAR(srgb(i, 0), srgb_code(i / 1000.0), 0.51) << i;
    EXPECT_NEAR(linear(i, 0), 0.255 * i, 0.51) << i;
  }
}

TEST(Develop, ClipsWhatIsBeyondFullScale) {
  Image<float> light(2, 1);
  light(0, 0) = -0.3F;
  light(1, 0) = 4.0F;
  const GrayImage image = develop(light, ResponseCurve::srgb(), {}, 1, 0);
  EXPECT_EQ(image(0, 0), 0);
  EXPECT_EQ(image(1, 0), 255);
}

TEST(Develop, NoiseHasTheVarianceOfElectrons) {
  const ImageFormation formation{.full_well = 9000.0, .read_noise = 9.0};
  for (const double level : {0.1, 0.4, 0.8}) {
    const Image<float> light(400, 400, static_cast<float>(level));
    const GrayImage image = develop(light, ResponseCurve::linear(), formation, 3, 2);
    double sum = 0, squares = 0;
    for (int y = 0; y < 400; ++y) {
      for (int x = 0; x < 400; ++x) {
        sum += image(x, y) / 255.0;
        squares += image(x, y) / 255.0 * image(x, y) / 255.0;
      }
    }
    const double mean = sum / 160000;
    const double electrons = level * 9000.0;
    const double expected =
        (electrons + 81.0) / (9000.0 * 9000.0) + 1.0 / (12 * 255.0 * 255.0);  // and rounding
    EXPECT_NEAR(mean, level, 2e-4);
    EXPECT_NEAR((squares / 160000 - mean * mean) / expected, 1.0, 0.03);
  }
}

TEST(Develop, NoiseIsKeyedBySeedAndFrame) {
  const Image<float> light(50, 50, 0.4F);
  const auto shot = [&](std::uint64_t seed, std::uint64_t frame) {
    return develop(light, ResponseCurve::srgb(), {}, seed, frame);
  };
  const auto differing = [](const GrayImage& a, const GrayImage& b) {
    int count = 0;
    for (int y = 0; y < 50; ++y) {
      for (int x = 0; x < 50; ++x) count += a(x, y) != b(x, y) ? 1 : 0;
    }
    return count;
  };
  EXPECT_EQ(differing(shot(1, 2), shot(1, 2)), 0);
  EXPECT_GT(differing(shot(1, 2), shot(1, 3)), 1000);
  EXPECT_GT(differing(shot(1, 2), shot(2, 2)), 1000);
}

TEST(ImageFormation, RejectsValuesOutOfRange) {
  EXPECT_THROW(ImageFormation{.lens_blur_sigma_px = -1.0}.check(), MisuseError);
  EXPECT_THROW(ImageFormation{.lens_blur_sigma_px = 0.1}.check(), MisuseError);
  EXPECT_NO_THROW(ImageFormation{.lens_blur_sigma_px = 0.0}.check());
  EXPECT_NO_THROW(ImageFormation{.lens_blur_sigma_px = 0.2}.check());
  EXPECT_THROW(ImageFormation{.full_well = 0.0}.check(), MisuseError);
  EXPECT_THROW(ImageFormation{.noise = std::nan("")}.check(), MisuseError);
}

}  // namespace
}  // namespace apriltrack
