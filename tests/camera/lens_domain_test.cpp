// Where lens models end, judged by closed forms and by scanning the formulas of OpenCV's documentation.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "apriltrack/camera/distortion.h"
#include "support/error_message.h"

namespace apriltrack {
namespace {

constexpr double kFineStep = 1e-5;

/// First r of a fine scan at which r f(r) no longer rises, has passed a pole, or exceeds 1000;
/// limit if there is none.
double scanned_fold(const std::vector<double>& k, double limit) {
  const auto seen = [&](double r) {
    const double s = r * r;
    const double k3 = k.size() > 4 ? k[4] : 0.0;
    const double denominator = k.size() > 5 ? 1 + k[5] * s + k[6] * s * s + k[7] * s * s * s : 1.0;
    return r * (1 + k[0] * s + k[1] * s * s + k3 * s * s * s) / denominator;
  };
  for (double r = kFineStep; r < limit; r += kFineStep) {
    if (seen(r) <= seen(r - kFineStep) || seen(r) > 1000.0) return r;
  }
  return limit;
}

TEST(RadtanDomain, EndsWhereOneNegativeCoefficientFoldsBack) {
  // d(r + k1 r^3)/dr = 0 at r = 1 / sqrt(-3 k1)
  for (const double k1 : {-0.28, -0.05, -1.0, -3.0}) {
    const double fold = 1.0 / std::sqrt(-3.0 * k1);
    const RadtanDistortion lens({k1, 0.0, 0.0, 0.0});
    EXPECT_NEAR(lens.max_radius(), fold, 2e-4 * fold);
    EXPECT_LT(lens.max_radius(), fold);
    EXPECT_TRUE(lens.distort({0.0, 0.999 * fold, 1.0}));
    EXPECT_FALSE(lens.distort({0.0, 1.001 * fold, 1.0}));
  }
}

TEST(RadtanDomain, HasNoEndWithoutAFold) {
  const std::vector<std::vector<double>> lenses = {{0, 0, 0, 0}, {0.1, 0.02, 0, 0}, {-0.28, 0.09, 0, 0}};
  for (const auto& k : lenses) {
    EXPECT_GT(RadtanDistortion(k).max_radius(), 6.0) << k[0];
    EXPECT_DOUBLE_EQ(scanned_fold(k, 6.0), 6.0);
  }
}

TEST(RadtanDomain, EndsWhereAFineScanSeesTheFold) {
  const std::vector<std::vector<double>> lenses = {
      {-0.4, 0.02, 0, 0},
      {0.12574925533818154, -0.29469338336037687, 0, 0},
      {-0.233024, 0.217972, 0, 0, -0.0913426},
      {0.8293548413467797, -1.563453123079522, 0, 0, 3.2612294894659852, 0.5712738259830856,
       0.16056556701700878, -0.11542135306858661},
      {-0.5, 0.1, 0, 0, -0.01, -0.2, 0.05, 0.01},
  };
  int folds = 0;
  for (const auto& k : lenses) {
    const double fold = scanned_fold(k, 5.0);
    const double claimed = RadtanDistortion(k).max_radius();
    EXPECT_NEAR(claimed, fold, 2e-4 * fold);
    folds += fold < 5.0 ? 1 : 0;
  }
  EXPECT_GE(folds, 4);
}

TEST(RadtanDomain, EndsBeforeAPole) {
  // 1 / (1 - 0.8 s): pole at r = sqrt(1.25)
  const RadtanDistortion lens({0, 0, 0, 0, 0, -0.8, 0, 0});
  EXPECT_LT(lens.max_radius(), std::sqrt(1.25));
  EXPECT_GT(lens.max_radius(), 0.99 * std::sqrt(1.25));
  EXPECT_FALSE(lens.distort({1.2, 0.0, 1.0}));
}

TEST(RadtanDomain, IsOneToOneWithStrongTangentialTerms) {
  // Positive definite Jacobian on the closed disc, by finite differences of the map itself.
  const RadtanDistortion lens({-0.1, 0.01, 0.06, -0.08});
  int count = 0;
  double smallest = 1e9;
  for (int k = 0; k < 90; ++k) {
    const double azimuth_rad = 2 * std::numbers::pi * k / 90;
    for (const double fraction : {0.5, 0.9, 0.99, 0.999}) {
      const double r = fraction * lens.max_radius();
      const Eigen::Vector3d point(r * std::cos(azimuth_rad), r * std::sin(azimuth_rad), 1.0);
      constexpr double h = 1e-6;
      const Eigen::Vector2d dx = (*lens.distort(point + h * Eigen::Vector3d::UnitX()) -
                                  *lens.distort(point - h * Eigen::Vector3d::UnitX())) /
                                 (2 * h);
      const Eigen::Vector2d dy = (*lens.distort(point + h * Eigen::Vector3d::UnitY()) -
                                  *lens.distort(point - h * Eigen::Vector3d::UnitY())) /
                                 (2 * h);
      const double mean = 0.5 * (dx.x() + dy.y());
      const double eigenvalue = mean - std::hypot(0.5 * (dx.x() - dy.y()), 0.5 * (dx.y() + dy.x()));
      EXPECT_GT(eigenvalue, 0.0) << "azimuth " << azimuth_rad << " fraction " << fraction;
      EXPECT_NEAR(dx.y(), dy.x(), 1e-7) << "the Jacobian is symmetric";
      smallest = std::min(smallest, eigenvalue);
      ++count;
    }
  }
  EXPECT_EQ(count, 360);
  EXPECT_LT(smallest, 0.01) << "the bound is tight: in its worst direction the fold is reached";
}

TEST(EquidistantDomain, EndsAtTheFoldOrAtPi) {
  // d(t + k1 t^3)/dt = 0 at t = 1 / sqrt(-3 k1)
  const double fold = 1.0 / std::sqrt(0.9);
  EXPECT_NEAR(EquidistantDistortion({-0.3, 0, 0, 0}).max_angle_rad(), fold, 2e-4);
  EXPECT_DOUBLE_EQ(EquidistantDistortion({0, 0, 0, 0}).max_angle_rad(), std::numbers::pi);
  EXPECT_DOUBLE_EQ(EquidistantDistortion({0.1, 0.01, 0, 0}).max_angle_rad(), std::numbers::pi);
}

TEST(EquidistantDomain, SeesPointsBesideAndBehindTheCamera) {
  // Without coefficients the distance from the centre is the angle itself.
  const EquidistantDistortion lens({0, 0, 0, 0});
  EXPECT_TRUE(lens.distort({2.0, 0.0, 0.0})->isApprox(Eigen::Vector2d(std::numbers::pi / 2, 0.0), 1e-15));
  EXPECT_TRUE(
      lens.distort({0.0, -1.0, -1.0})->isApprox(Eigen::Vector2d(0.0, -0.75 * std::numbers::pi), 1e-15));
  EXPECT_FALSE(lens.distort({0.0, 0.0, -1.0}));
  EXPECT_TRUE(lens.undistort({0.0, -0.75 * std::numbers::pi})
                  ->isApprox(Eigen::Vector3d(0.0, -std::sqrt(0.5), -std::sqrt(0.5)), 1e-14));
}

TEST(EquidistantJacobian, IsFiniteOnTheAxis) {
  Eigen::Matrix<double, 2, 3> jacobian;
  ASSERT_TRUE(EquidistantDistortion({-0.02, 0.01, 0, 0}).distort({0.0, 0.0, 2.0}, &jacobian));
  Eigen::Matrix<double, 2, 3> expected;
  expected << 0.5, 0.0, 0.0, 0.0, 0.5, 0.0;
  EXPECT_TRUE(jacobian.isApprox(expected, 1e-15));
}

TEST(Distortion, RefusesWrongNumbersOfCoefficients) {
  using test::message_of;
  EXPECT_EQ(message_of([] {
              RadtanDistortion({0.1, 0.2});
            }),
            "RadtanDistortion: takes 4, 5 or 8 coefficients (there are 2)");
  EXPECT_EQ(message_of([] {
              RadtanDistortion({0.1, 0.2, 0.0, 0.0, 0.0, 0.0});
            }),
            "RadtanDistortion: takes 4, 5 or 8 coefficients (there are 6)");
  EXPECT_EQ(message_of([] {
              RadtanDistortion({0.1, std::nan(""), 0.0, 0.0});
            }),
            "RadtanDistortion: coefficients[1] must be finite (is nan)");
  EXPECT_EQ(message_of([] {
              EquidistantDistortion({0.1, 0.2, 0.3});
            }),
            "EquidistantDistortion: takes 4 coefficients (there are 3)");
  EXPECT_EQ(message_of([] {
              EquidistantDistortion({0.1, 0.2, 0.3, HUGE_VAL});
            }),
            "EquidistantDistortion: coefficients[3] must be finite (is inf)");
}

}  // namespace
}  // namespace apriltrack
