#include "apriltrack/tags/blurred_pattern.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <utility>

#include "apriltrack/tags/tag_family.h"
#include "support/numeric_jacobian.h"

namespace apriltrack {
namespace {

/// The Gaussian's integral as a sum over a fine grid, cell by cell as the family says.
double summed_light(const TagPattern& pattern, const PatternBlur& blur, double u, double v) {
  constexpr int kHalf = 400;
  constexpr double kReach = 5.0;
  const double rho = blur.covariance_uv / (blur.sigma_u * blur.sigma_v);
  double sum = 0.0, weights = 0.0;
  for (int i = -kHalf; i <= kHalf; ++i) {
    for (int k = -kHalf; k <= kHalf; ++k) {
      const double a = kReach * i / kHalf, b = kReach * k / kHalf;
      const double weight = std::exp(-0.5 * (a * a - 2.0 * rho * a * b + b * b) / (1.0 - rho * rho));
      const double at_u = u + a * blur.sigma_u, at_v = v + b * blur.sigma_v;
      sum += weight * pattern.brightness(at_u, at_v);
      weights += weight;
    }
  }
  return sum / weights;
}

constexpr double kPlaces[][2] = {{0.03, -0.41}, {-0.99, 0.2}, {0.77, 0.74}, {-1.2, -1.24}, {0.26, 0.24}};

TEST(BlurredPattern, IsTheIntegralOfTheCells) {
  const TagPattern pattern = TagFamily::get("tag36h11").pattern(11);
  for (const PatternBlur blur : {PatternBlur{0.03, 0.05}, {0.08, 0.04}, {0.2, 0.3}}) {
    for (const auto& [u, v] : kPlaces)
      EXPECT_NEAR(BlurredPattern(pattern).at(u, v, blur).light, summed_light(pattern, blur, u, v), 4e-3)
          << u << ' ' << v;
  }
}

TEST(BlurredPattern, SmearsAskewWherePlanesAreSeenAskew) {
  const TagPattern pattern = TagFamily::get("tag36h11").pattern(11);
  const BlurredPattern blurred(pattern);
  for (const double correlation : {-0.92, -0.6, -0.3, 0.31, 0.45, 0.75, 0.88}) {
    const PatternBlur askew{0.13, 0.1, correlation * 0.13 * 0.1};
    double largest = 0.0;
    for (const auto& [u, v] : kPlaces) {
      const double light = blurred.at(u, v, askew).light;
      EXPECT_NEAR(light, summed_light(pattern, askew, u, v), 6e-3) << correlation << ' ' << u << ' ' << v;
      largest = std::max(largest, std::abs(light - blurred.at(u, v, {0.13, 0.1, 0.0}).light));
    }
    EXPECT_GT(largest, 0.03 * std::abs(correlation)) << correlation;  // it matters
  }
}

TEST(BlurredPattern, KnowsItsDerivatives) {
  const TagPattern pattern = TagFamily::get("tag36h11").pattern(11);
  const BlurredPattern blurred(pattern);
  // Exact along the axes; of a correlated blur as the series has it, which is enough for a step of a fit. By
  // changes of one sigma, or of its square.
  for (const auto& [correlation, tolerance] : {std::pair(0.0, 1e-4), {0.1, 0.015}, {0.6, 0.06}}) {
    Eigen::Matrix2d covariance;
    covariance << 0.07 * 0.07, correlation * 0.07 * 0.05, correlation * 0.07 * 0.05, 0.05 * 0.05;
    for (const auto& [u, v] : kPlaces) {
      const PatternSample sample = blurred.at(u, v, PatternBlur::of(covariance));
      const auto light = [&, u = u, v = v](const Eigen::VectorXd& d) {  // Clang 14 captures no bindings
        Eigen::Matrix2d other = covariance;
        other(0, 0) *= 1.0 + d[2], other(1, 1) *= 1.0 + d[3];
        other(0, 1) += 0.07 * 0.05 * d[4], other(1, 0) = other(0, 1);
        return Eigen::VectorXd::Constant(
            1, blurred.at(u + 0.07 * d[0], v + 0.05 * d[1], PatternBlur::of(other)).light);
      };
      Eigen::Matrix<double, 1, 5> own;
      own << 0.07 * sample.by_u, 0.05 * sample.by_v, 0.5 * 0.07 * 0.07 * sample.by_uu,
          0.5 * 0.05 * 0.05 * sample.by_vv, 0.07 * 0.05 * sample.by_uv;
      EXPECT_TRUE(test::jacobians_agree(own, test::numeric_jacobian(light, 5, 1e-5), tolerance))
          << correlation << ' ' << u << ' ' << v;
    }
  }
}

TEST(BlurredPattern, TellsWhatIsNotPrinted) {
  const BlurredPattern blurred(TagFamily::get("tag36h11").pattern(0));
  const double edge = TagFamily::get("tag36h11").pattern(0).half_extent();
  const PatternBlur blur{0.05, 0.05};
  EXPECT_NEAR(blurred.at(0.3, -0.2, blur).known, 1.0, 1e-3);
  EXPECT_NEAR(blurred.at(edge, 0.0, blur).known, 0.5, 1e-3);
  EXPECT_NEAR(blurred.at(2.0, 0.0, blur).known, 0.0, 1e-3);
  const BlurredPattern hollow(TagFamily::get("tagCustom48h12").pattern(0));  // nothing in its middle
  EXPECT_NEAR(hollow.at(0.0, 0.0, {0.02, 0.02}).known, 0.0, 1e-3);
}

TEST(BlurredPattern, TellsHowMuchLiesBeyondEachSide) {
  const TagPattern pattern = TagFamily::get("tag36h11").pattern(0);
  const BlurredPattern blurred(pattern);
  const double edge = pattern.half_extent();
  const PatternBlur blur{0.05, 0.08};
  const double one_sigma = 0.5 * std::erfc(1.0 / std::sqrt(2.0));  // of a normal distribution beyond 1
  using Shares = std::array<double, kNumPatternSides>;
  const auto expect_near = [&](double u, double v, const Shares& expected) {
    const Shares beyond = blurred.at(u, v, blur).beyond;
    for (std::size_t side = 0; side < expected.size(); ++side)
      EXPECT_NEAR(beyond[side], expected[side], 1e-5) << u << ' ' << v << " side " << side;
  };
  expect_near(0.0, 0.0, {0.0, 0.0, 0.0, 0.0});
  expect_near(-edge + 0.05, 0.0, {one_sigma, 0.0, 0.0, 0.0});
  expect_near(edge - 0.05, 0.0, {0.0, one_sigma, 0.0, 0.0});
  expect_near(0.0, -edge, {0.0, 0.0, 0.5, 0.0});
  expect_near(0.0, edge + 0.08, {0.0, 0.0, 0.0, 1.0 - one_sigma});
  expect_near(edge + 1.0, edge + 1.0, {0.0, 1.0, 0.0, 1.0});
}

}  // namespace
}  // namespace apriltrack
