#include "apriltrack/camera/camera_model.h"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <numbers>

#include "lens_models.h"
#include "support/error_message.h"
#include "support/numeric_jacobian.h"

namespace apriltrack {
namespace {

using std::numbers::pi;
using test::Lens;

constexpr double kMaxRoundTrip_px = 1e-9;

Eigen::Vector3d ray_at(double angle_rad, double azimuth_rad) {
  return {std::sin(angle_rad) * std::cos(azimuth_rad), std::sin(angle_rad) * std::sin(azimuth_rad),
          std::cos(angle_rad)};
}

/// Of the limit: dense in the middle, close to the fold at the end.
std::vector<double> fractions_of_limit() {
  std::vector<double> fractions;
  for (int i = 0; i < 60; ++i) fractions.push_back(i / 60.0);
  for (const double gap : {1e-2, 1e-3, 1e-4, 1e-6, 1e-9}) fractions.push_back(1.0 - gap);
  return fractions;
}

/// Calls function(ray, fraction) on a dense grid of the valid domain. The plane of a pinhole lens ends in
/// infinity: at 89.8 degrees its pixels are 300 focal lengths away, where a double holds no billionth of one.
template <class Function>
int for_each_ray(const Lens& lens, const Function& function) {
  const bool is_fisheye = lens.model.distortion_name() == "equidistant";
  const double widest_rad = is_fisheye ? pi : 89.0 * pi / 180.0;
  int count = 0;
  for (const double fraction : fractions_of_limit()) {
    const double angle_rad = fraction * std::min(lens.max_angle_rad, widest_rad);
    for (int k = 0; k < 24; ++k) {
      function(ray_at(angle_rad, 2.0 * pi * k / 24.0 + 0.1), fraction);
      ++count;
    }
  }
  return count;
}

class EveryLens : public ::testing::TestWithParam<Lens> {};

INSTANTIATE_TEST_SUITE_P(Lenses, EveryLens, ::testing::ValuesIn(test::all_lenses()),
                         [](const auto& lens) { return lens.param.name; });

TEST_P(EveryLens, SeesEveryRayOfItsDomainAndFindsItAgain) {
  const CameraModel& model = GetParam().model;
  const int count = for_each_ray(GetParam(), [&](const Eigen::Vector3d& ray, double fraction) {
    const auto pixel = model.project(3.7 * ray);
    ASSERT_TRUE(pixel) << ray.transpose();
    const auto found = model.unproject(*pixel);
    ASSERT_TRUE(found) << "pixel " << pixel->transpose() << " fraction " << fraction;
    EXPECT_NEAR(found->norm(), 1.0, 1e-14);
    const auto again = model.project(*found);
    ASSERT_TRUE(again);
    // Relative beyond 1000 px, where rounding of the pixel itself is felt.
    EXPECT_LE((*again - *pixel).norm(), kMaxRoundTrip_px * std::max(1.0, pixel->norm() / 1000.0))
        << "fraction " << fraction;
    // At the very fold one pixel belongs to two rays; a little inside, the ray itself must come back.
    if (fraction < 0.995) {
      EXPECT_LE((*found - ray).norm(), 1e-9) << "fraction " << fraction;
    }
  });
  EXPECT_GT(count, 1000);
}

TEST_P(EveryLens, JacobianIsTheSlope) {
  const CameraModel& model = GetParam().model;
  int count = 0;
  for_each_ray(GetParam(), [&](const Eigen::Vector3d& ray, double fraction) {
    if (fraction > 0.985) return;  // finite differences need neighbours on both sides
    const Eigen::Vector3d point = 2.3 * ray;
    Eigen::Matrix<double, 2, 3> jacobian;
    jacobian.setConstant(std::numeric_limits<double>::quiet_NaN());
    const auto pixel = model.project(point, &jacobian);
    ASSERT_TRUE(pixel);
    EXPECT_EQ(*pixel, *model.project(point)) << "asking for the Jacobian must not change the answer";
    const auto numeric = test::numeric_jacobian(
        [&](const Eigen::VectorXd& delta) -> Eigen::VectorXd {
          return *model.project(point + delta.head<3>());
        },
        3, fraction < 0.95 ? 1e-5 : 1e-6);
    EXPECT_TRUE(test::jacobians_agree(jacobian, numeric, fraction < 0.95 ? 1e-6 : 1e-4)) << point.transpose();
    ++count;
  });
  EXPECT_GT(count, 1000);
}

TEST_P(EveryLens, PixelsMoveOutwardsWithTheAngle) {
  const CameraModel& model = GetParam().model;
  const auto& pinhole = model.pinhole();
  const bool is_fisheye = model.distortion_name() == "equidistant";
  int count = 0;
  for (int k = 0; k < 16; ++k) {
    const double azimuth_rad = 2.0 * pi * k / 16.0 + 0.05;
    const Eigen::Vector2d outwards(std::cos(azimuth_rad) * pinhole.fx, std::sin(azimuth_rad) * pinhole.fy);
    double last = -1.0;
    for (int i = 0; i < 500; ++i) {
      const double angle_rad = i / 500.0 * std::min(GetParam().max_angle_rad, is_fisheye ? pi : 1.55);
      const auto pixel = model.project(ray_at(angle_rad, azimuth_rad));
      ASSERT_TRUE(pixel);
      const double along = (*pixel - Eigen::Vector2d(pinhole.cx, pinhole.cy)).dot(outwards.normalized());
      EXPECT_GT(along, last);
      last = along;
      ++count;
    }
  }
  EXPECT_EQ(count, 16 * 500);
}

TEST_P(EveryLens, RefusesWhatLiesBeyondItsDomain) {
  const Lens& lens = GetParam();
  for (int k = 0; k < 12; ++k) {
    for (const double beyond : {1e-6, 1e-3, 0.1, 0.5}) {
      const double angle_rad = lens.max_angle_rad + beyond;
      if (angle_rad > pi) continue;
      EXPECT_FALSE(lens.model.project(ray_at(angle_rad, k * pi / 6.0))) << angle_rad;
    }
  }
  EXPECT_FALSE(lens.model.project({0.0, 0.0, 0.0}));
  EXPECT_FALSE(lens.model.project({0.0, 0.0, -1.0}));
}

TEST_P(EveryLens, NeverAnswersWithNan) {
  const CameraModel& model = GetParam().model;
  const double inf = std::numeric_limits<double>::infinity();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<double> values = {0.0,   -0.0,   1.0,   -1.0, 1e-320, 1e-300, -1e-300,
                                      1e300, -1e300, 1e154, inf,  -inf,   nan};
  int seen = 0;
  for (const double x : values) {
    for (const double y : values) {
      for (const double z : values) {
        Eigen::Matrix<double, 2, 3> jacobian;
        const auto pixel = model.project({x, y, z}, &jacobian);
        if (!pixel) continue;
        ++seen;
        EXPECT_TRUE(pixel->allFinite()) << x << " " << y << " " << z;
      }
      const auto ray = model.unproject({x, y});
      if (ray) {
        EXPECT_NEAR(ray->norm(), 1.0, 1e-12) << x << " " << y;
      }
    }
  }
  EXPECT_GT(seen, 10);
}

TEST_P(EveryLens, UnprojectsItsPrincipalPointToTheAxis) {
  const auto& pinhole = GetParam().model.pinhole();
  EXPECT_EQ(*GetParam().model.unproject({pinhole.cx, pinhole.cy}), Eigen::Vector3d::UnitZ());
}

TEST_P(EveryLens, EveryPixelOfItsPictureIsSeenOrRefused) {
  // 1e-9 px for every pixel that has a ray at all, over a picture far larger than the lens's.
  const CameraModel& model = GetParam().model;
  int seen = 0;
  for (int y = -1000; y <= 2000; y += 37) {
    for (int x = -1000; x <= 2500; x += 41) {
      const Eigen::Vector2d pixel(x, y);
      const auto ray = model.unproject(pixel);
      if (!ray) continue;
      ++seen;
      const auto again = model.project(*ray);
      ASSERT_TRUE(again) << pixel.transpose();
      EXPECT_LE((*again - pixel).norm(), kMaxRoundTrip_px * std::max(1.0, pixel.norm() / 1000.0))
          << pixel.transpose();
    }
  }
  EXPECT_GT(seen, 50);
}

TEST(CameraModel, RefusesFocalLengthsThatAreNone) {
  const auto message_for = [](const Pinhole& pinhole) {
    return test::message_of([&] { CameraModel(pinhole, NoDistortion()); });
  };
  EXPECT_EQ(message_for({0.0, 500.0, 320.0, 240.0}), "Pinhole: fx must be finite and > 0 pixels (is 0)");
  EXPECT_EQ(message_for({500.0, -1.5, 320.0, 240.0}), "Pinhole: fy must be finite and > 0 pixels (is -1.5)");
  EXPECT_EQ(message_for({500.0, 500.0, std::nan(""), 240.0}),
            "Pinhole: cx must be a finite number of pixels (is nan)");
  EXPECT_EQ(message_for({500.0, 500.0, 320.0, HUGE_VAL}),
            "Pinhole: cy must be a finite number of pixels (is inf)");
}

}  // namespace
}  // namespace apriltrack
