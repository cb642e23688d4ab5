#include "apriltrack/image/response.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "apriltrack/base/check.h"

namespace apriltrack {
namespace {

constexpr double kFloat = 1e-6;  // tables hold floats

TEST(ResponseCurve, LinearIsTheCodeOverFullScale) {
  const ResponseCurve curve = ResponseCurve::linear();
  for (int code = 0; code < 256; ++code)
    EXPECT_NEAR(curve.to_linear(static_cast<std::uint8_t>(code)), code / 255.0, kFloat);
  EXPECT_TRUE(curve.is_linear());
  EXPECT_EQ(curve.name(), "linear");
}

TEST(ResponseCurve, SrgbHasThePublishedValues) {
  // IEC 61966-2-1: linear below code 10.31, a power of 2.4 above. The values are computed apart from the
  // standard's formula.
  const ResponseCurve curve = ResponseCurve::srgb();
  EXPECT_EQ(curve.to_linear(0), 0.0F);
  EXPECT_NEAR(curve.to_linear(1), 1.0 / 255.0 / 12.92, kFloat);
  EXPECT_NEAR(curve.to_linear(10), 10.0 / 255.0 / 12.92, kFloat);
  EXPECT_NEAR(curve.to_linear(11), 0.003346535763899, kFloat);
  EXPECT_NEAR(curve.to_linear(64), 0.051269458374043, kFloat);
  EXPECT_NEAR(curve.to_linear(128), 0.215860500113899, kFloat);
  EXPECT_NEAR(curve.to_linear(188), 0.502886458032669, kFloat);
  EXPECT_NEAR(curve.to_linear(255), 1.0, kFloat);
  EXPECT_FALSE(curve.is_linear());
  EXPECT_EQ(curve.name(), "srgb");
}

TEST(ResponseCurve, SrgbInvertsItsEncoding) {
  // The encoding direction is the standard's own formula, 1.055 L^(1/2.4) - 0.055, not the decoder turned
  // round.
  const ResponseCurve curve = ResponseCurve::srgb();
  for (int code = 0; code < 256; ++code) {
    const double light = curve.to_linear(static_cast<std::uint8_t>(code));
    const double encoded = light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1.0 / 2.4) - 0.055;
    EXPECT_NEAR(encoded * 255.0, code, 1e-3);
  }
}

TEST(ResponseCurve, GammaIsAPower) {
  const ResponseCurve curve = ResponseCurve::gamma(2.0);
  EXPECT_NEAR(curve.to_linear(51), 0.04, kFloat);
  EXPECT_NEAR(curve.to_linear(102), 0.16, kFloat);
  EXPECT_NEAR(curve.to_linear(255), 1.0, kFloat);
  EXPECT_EQ(ResponseCurve::gamma(2.2).name(), "gamma:2.2");
  EXPECT_NEAR(ResponseCurve::gamma(1.0).to_linear(77), ResponseCurve::linear().to_linear(77), kFloat);
}

TEST(ResponseCurve, RefusesExponentsOutOfRange) {
  EXPECT_THROW(ResponseCurve::gamma(0.1), MisuseError);
  EXPECT_THROW(ResponseCurve::gamma(5.1), MisuseError);
  EXPECT_THROW(ResponseCurve::gamma(std::numeric_limits<double>::quiet_NaN()), MisuseError);
}

TEST(ResponseCurve, RefusesTablesThatDecreaseOrAreNotFinite) {
  std::array<float, 256> table{};
  for (int i = 0; i < 256; ++i) table[static_cast<std::size_t>(i)] = static_cast<float>(i) / 255.0F;
  EXPECT_NO_THROW(ResponseCurve{table});
  auto decreasing = table;
  decreasing[100] = 0.1F;
  EXPECT_THROW(ResponseCurve{decreasing}, MisuseError);
  auto not_finite = table;
  not_finite[255] = std::numeric_limits<float>::infinity();
  EXPECT_THROW(ResponseCurve{not_finite}, MisuseError);
}

TEST(ToLinearLight, MapsEveryPixelOfAPaddedView) {
  const std::vector<std::uint8_t> memory = {0, 128, 200, 255, 64, 200};
  const GrayView view(memory.data(), 2, 2, 3);
  const Image<float> light = to_linear_light(view, ResponseCurve::srgb());
  ASSERT_EQ(light.width(), 2);
  ASSERT_EQ(light.height(), 2);
  EXPECT_NEAR(light(0, 0), 0.0, kFloat);
  EXPECT_NEAR(light(1, 0), 0.215860500113899, kFloat);
  EXPECT_NEAR(light(0, 1), 1.0, kFloat);
  EXPECT_NEAR(light(1, 1), 0.051269458374043, kFloat);
}

TEST(LinearToSrgbBytes, IsUndoneBySrgbsResponse) {
  GrayImage image(256, 1);
  for (int x = 0; x < 256; ++x) image(x, 0) = static_cast<std::uint8_t>(x);
  const GrayImage back = to_linear_bytes(linear_to_srgb_bytes(image.view()).view(), ResponseCurve::srgb());
  // sRGB's codes are 2.3 levels of light apart where they are farthest, at full scale; half of that, and
  // rounding.
  for (int x = 0; x < 256; ++x) EXPECT_NEAR(back(x, 0), x, 1.65) << x;
}

TEST(ToLinearBytes, RoundsToTheNearestByte) {
  GrayImage image(256, 1);
  for (int i = 0; i < 256; ++i) image(i, 0) = static_cast<std::uint8_t>(i);
  const GrayImage bytes = to_linear_bytes(image.view(), ResponseCurve::gamma(2.0));
  for (int i = 0; i < 256; ++i) EXPECT_NEAR(bytes(i, 0), i * i / 255.0, 0.5 + 1e-4) << i;
  const GrayImage same = to_linear_bytes(image.view(), ResponseCurve::linear());
  for (int i = 0; i < 256; ++i) EXPECT_EQ(same(i, 0), i);
}

}  // namespace
}  // namespace apriltrack
