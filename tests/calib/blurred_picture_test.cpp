#include "blurred_picture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "apriltrack/tags/tag_family.h"
#include "support/numeric_jacobian.h"

namespace apriltrack {
namespace {

/// The Gaussian's integral as a sum over a fine grid, cell by cell as the family says.
double summed_light(const TagPattern& pattern, const PictureBlur& blur, double u, double v) {
  constexpr int kHalf = 400;
  constexpr double kReach = 5.0;
  const double rho = blur.covariance_uv / (blur.sigma_u * blur.sigma_v);
  double sum = 0.0, weights = 0.0;
  for (int i = -kHalf; i <= kHalf; ++i) {
    for (int k = -kHalf; k <= kHalf; ++k) {
      const double a = kReach * i / kHalf, b = kReach * k / kHalf;
      const double weight = std::exp(-0.5 * (a * a - 2.0 * rho * a * b + b * b) / (1.0 - rho * rho));
      const double at_u = u + a * blur.sigma_u, at_v = v + b * blur.sigma_v;
      const bool is_printed = std::max(std::abs(at_u), std::abs(at_v)) <= pattern.half_extent();
      if (is_printed) sum += weight * pattern.brightness(at_u, at_v);
      weights += weight;
    }
  }
  return sum / weights;
}

constexpr double kPlaces[][2] = {{0.03, -0.41}, {-0.99, 0.2}, {0.77, 0.74}, {-1.2, -1.24}, {0.26, 0.24}};

TEST(BlurredPicture, IsTheIntegralOfTheCells) {
  const TagPattern pattern = TagFamily::get("tag36h11").pattern(11);
  for (const PictureBlur blur : {PictureBlur{0.03, 0.05}, {0.08, 0.04}, {0.2, 0.3}}) {
    for (const auto& [u, v] : kPlaces)
      EXPECT_NEAR(BlurredPicture(pattern, blur).at(u, v).light, summed_light(pattern, blur, u, v), 4e-3)
          << u << ' ' << v;
  }
}

TEST(BlurredPicture, SmearsAskewWherePlanesAreSeenAskew) {
  const TagPattern pattern = TagFamily::get("tag36h11").pattern(11);
  const PictureBlur askew{0.06, 0.05, 0.4 * 0.06 * 0.05};
  double largest = 0.0;
  for (const auto& [u, v] : kPlaces) {
    const double light = BlurredPicture(pattern, askew).at(u, v).light;
    EXPECT_NEAR(light, summed_light(pattern, askew, u, v), 8e-3) << u << ' ' << v;
    const double straight = BlurredPicture(pattern, {askew.sigma_u, askew.sigma_v, 0.0}).at(u, v).light;
    largest = std::max(largest, std::abs(light - straight));
  }
  EXPECT_GT(largest, 0.03);  // it matters
}

TEST(BlurredPicture, KnowsItsDerivatives) {
  const TagPattern pattern = TagFamily::get("tag36h11").pattern(11);
  const PictureBlur blur{0.07, 0.05};
  for (const auto& [u, v] : kPlaces) {
    const PictureSample sample = BlurredPicture(pattern, blur).at(u, v);
    const auto light = [&](const Eigen::VectorXd& d) {
      const PictureBlur wider{blur.sigma_u * std::exp(d[2]), blur.sigma_v * std::exp(d[3])};
      return Eigen::VectorXd::Constant(1, BlurredPicture(pattern, wider).at(u + d[0], v + d[1]).light);
    };
    Eigen::RowVector4d own;
    own << sample.by_u, sample.by_v, sample.by_log_sigma_u, sample.by_log_sigma_v;
    EXPECT_TRUE(test::jacobians_agree(own, test::numeric_jacobian(light, 4, 1e-4), 3e-3)) << u << ' ' << v;
  }
}

TEST(BlurredPicture, TellsWhatIsNotPrinted) {
  const TagPattern pattern = TagFamily::get("tag36h11").pattern(0);
  const BlurredPicture picture(pattern, {0.05, 0.05});
  EXPECT_NEAR(picture.at(0.3, -0.2).known, 1.0, 1e-3);
  EXPECT_NEAR(picture.at(pattern.half_extent(), 0.0).known, 0.5, 1e-3);
  EXPECT_NEAR(picture.at(2.0, 0.0).known, 0.0, 1e-3);
  const TagPattern hollow = TagFamily::get("tagCustom48h12").pattern(0);  // nothing in its middle
  EXPECT_NEAR(BlurredPicture(hollow, {0.02, 0.02}).at(0.0, 0.0).known, 0.0, 1e-3);
}

}  // namespace
}  // namespace apriltrack
