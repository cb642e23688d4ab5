#include "code_curve.h"

#include <gtest/gtest.h>

namespace apriltrack {
namespace {

TEST(CodeCurve, IsTheResponseTheOtherWayRound) {
  for (const ResponseCurve& response :
       {ResponseCurve::linear(), ResponseCurve::srgb(), ResponseCurve::gamma(1.7)}) {
    const CodeCurve curve(response);
    for (const int code : {2, 3, 40, 128, 254, 255}) {
      const double light = static_cast<double>(response.to_linear(static_cast<std::uint8_t>(code)));
      EXPECT_NEAR(255.0 * curve.at(light).code, code, 1e-3) << response.name();
      EXPECT_NEAR(curve.light(code / 255.0), light, 1e-6) << response.name();
    }
  }
}

TEST(CodeCurve, GoesOnBeyondBlackAndFullScale) {
  const CodeCurve curve = CodeCurve::gamma(2.2);
  EXPECT_LT(curve.at(-0.01).code, curve.at(0.0).code);
  EXPECT_GT(curve.at(1.1).code, 1.0);
}

TEST(CodeCurve, KnowsItsDerivatives) {
  constexpr double kStep = 0.01, kExponent = 1.8;
  const CodeCurve curve = CodeCurve::gamma(kExponent);
  for (const double light : {0.1, 0.4, 0.9}) {
    const CodeCurve::Sample sample = curve.at(light);
    EXPECT_NEAR(sample.by_light, (curve.at(light + kStep).code - curve.at(light - kStep).code) / (2 * kStep),
                0.02 * sample.by_light);
    const double more = CodeCurve::gamma(kExponent + kStep).at(light).code;
    const double less = CodeCurve::gamma(kExponent - kStep).at(light).code;
    EXPECT_NEAR(sample.by_exponent, (more - less) / (2 * kStep), 1e-3);
  }
}

TEST(CodeCurve, NearestExponentIsTheCurvesOwn) {
  EXPECT_NEAR(nearest_exponent(ResponseCurve::linear()), 1.0, 1e-9);
  EXPECT_NEAR(nearest_exponent(ResponseCurve::gamma(1.7)), 1.7, 1e-9);
  EXPECT_NEAR(nearest_exponent(ResponseCurve::srgb()), 2.25, 0.06);
}

}  // namespace
}  // namespace apriltrack
