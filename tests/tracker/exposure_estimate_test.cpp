#include "exposure_estimate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "apriltrack/base/random.h"
#include "path_ratio.h"

namespace apriltrack::test {
namespace {

/// Of a pinhole camera with a focal length of 500 px: corners of a square of 0.4 m, 2 m before it.
Eigen::Matrix<double, Eigen::Dynamic, 6> square_before_camera() {
  Eigen::Matrix<double, Eigen::Dynamic, 6> J(8, 6);
  Eigen::Index row = 0;
  for (const double x : {-0.2, 0.2}) {
    for (const double y : {-0.2, 0.2}) {
      const Eigen::Vector3d p(x, y, 2.0);
      Eigen::Matrix<double, 2, 3> by_point;
      by_point << 1.0 / p.z(), 0.0, -p.x() / (p.z() * p.z()), 0.0, 1.0 / p.z(), -p.y() / (p.z() * p.z());
      // A camera that moves by (u, w) sees the point move by -u - w x p.
      Eigen::Matrix<double, 3, 6> moved;
      moved << -Eigen::Matrix3d::Identity(), Eigen::Matrix3d::Zero();
      moved.rightCols<3>() << 0.0, -p.z(), p.y(), p.z(), 0.0, -p.x(), -p.y(), p.x(), 0.0;
      J.middleRows<2>(row) = 500.0 * by_point * moved;
      row += 2;
    }
  }
  return J;
}

Timestamp at_s(double time_s) {
  return {static_cast<std::int64_t>(std::llround(1e9 * time_s))};
}

/// Angle and place at a time, and their changes, about and along fixed axes.
struct Swing {
  double angle, angular_speed, x, speed;
};

/// As a tracker would find it whose exposure is off by `factor`: true over told.
template <typename SwingAt>
BlurredInstant instant(const SwingAt& swing_at, double time_s, double factor, double exposure_s = 0.01) {
  const Swing swing = swing_at(time_s);
  BlurredInstant frame;
  frame.time = at_s(time_s);
  const Eigen::Quaterniond rotation(Eigen::AngleAxisd(swing.angle, Eigen::Vector3d::UnitY()));
  frame.pose = {rotation, Eigen::Vector3d(swing.x, 0.1, -0.2)};
  frame.exposure_s = exposure_s;
  frame.velocity << factor * (rotation.conjugate() * Eigen::Vector3d(swing.speed, 0.0, 0.0)),
      factor * swing.angular_speed * Eigen::Vector3d::UnitY();
  frame.pixels_by_pose = square_before_camera();
  return frame;
}

template <typename SwingAt>
std::optional<PathRatio> ratio_of(const SwingAt& swing_at, std::array<double, 3> times_s, double factor) {
  return path_ratio({instant(swing_at, times_s[0], factor), instant(swing_at, times_s[1], factor),
                     instant(swing_at, times_s[2], factor)},
                    MotionNoise());
}

Swing even_motion(double t) {
  return {0.8 * t, 0.8, 1.7 * t, 1.7};
}
Swing growing_motion(double t) {
  return {0.5 * t + 4.0 * t * t, 0.5 + 8.0 * t, 1.2 * t + 3.0 * t * t, 1.2 + 6.0 * t};
}

TEST(PathRatio, IsThatOfTheExposuresWhereTheMotionIsEven) {
  for (const double factor : {0.1, 0.8, 1.0, 1.25, 3.0}) {
    const auto seen = ratio_of(even_motion, {1.0, 1.033, 1.066}, factor);
    ASSERT_TRUE(seen) << factor;
    EXPECT_NEAR(seen->ratio, factor, 1e-9);
  }
}

TEST(PathRatio, HoldsForConstantAccelerationAndUnevenTimes) {
  for (const auto& times_s : {std::array{0.1, 0.133, 0.166}, {0.1, 0.166, 0.199}, {0.1, 0.12, 0.16}}) {
    const auto seen = ratio_of(growing_motion, times_s, 1.2);
    ASSERT_TRUE(seen);
    EXPECT_NEAR(seen->ratio, 1.2, 1e-6) << times_s[1];
  }
}

TEST(PathRatio, IsNotBiasedByAShakingHand) {
  double sum = 0.0, weights = 0.0;
  const double rate = 2.0 * std::numbers::pi * 3.0;  // 3 Hz: 10 frames
  const auto shaken = [&](double t) -> Swing {
    return {0.1 * std::sin(rate * t), 0.1 * rate * std::cos(rate * t), 0.06 * std::sin(rate * t),
            0.06 * rate * std::cos(rate * t)};
  };
  for (int i = 0; i < 100; ++i) {
    const double t = 0.0331 * i;
    const auto seen = ratio_of(shaken, {t, t + 1.0 / 30.0, t + 2.0 / 30.0}, 1.3);
    if (!seen) continue;
    const double weight = 1.0 / seen->variance;
    sum += weight * seen->ratio;
    weights += weight;
  }
  ASSERT_GT(weights, 0.0);
  EXPECT_NEAR(sum / weights, 1.3, 0.03);
}

TEST(PathRatio, TakesTheReversedPathForWhatItIs) {
  std::array frames = {instant(even_motion, 1.0, 1.2), instant(even_motion, 1.033, 1.2),
                       instant(even_motion, 1.066, 1.2)};
  for (BlurredInstant& frame : frames) {
    frame.velocity = -frame.velocity;
    const auto seen = path_ratio(frames, MotionNoise());
    ASSERT_TRUE(seen);
    EXPECT_NEAR(seen->ratio, 1.2, 1e-6);
  }
}

TEST(PathRatio, SaysNothingWhereNothingMovesOrFramesLieFarApart) {
  const auto still = [](double) -> Swing { return {0.3, 0.0, 0.4, 0.0}; };
  EXPECT_FALSE(ratio_of(still, {1.0, 1.033, 1.066}, 1.2));
  EXPECT_FALSE(ratio_of(even_motion, {1.0, 1.2, 1.4}, 1.2));
  EXPECT_FALSE(ratio_of(even_motion, {1.0, 1.03, 1.15}, 1.2));
  EXPECT_FALSE(ratio_of(even_motion, {1.0, 1.0, 1.033}, 1.2));
}

TEST(PathRatio, SaysNothingWhereAFilmIsCut) {
  // Even motions, but the last frame is of another place, or of another turn: what lies between was no path.
  for (const double angle : {0.0, 0.8}) {
    std::array frames = {instant(even_motion, 1.0, 1.0), instant(even_motion, 1.033, 1.0),
                         instant(even_motion, 1.066, 1.0)};
    EXPECT_TRUE(path_ratio(frames, MotionNoise()));
    const Pose elsewhere(Eigen::Quaterniond(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ())),
                         Eigen::Vector3d(angle > 0.0 ? 0.0 : 0.6, 0.0, 0.0));
    frames[2].pose = frames[2].pose * elsewhere;
    EXPECT_FALSE(path_ratio(frames, MotionNoise())) << angle;
  }
}

TEST(PathRatio, TakesNoDepthThatIsKnownBadlyForAJump) {
  // At 120 Hz, half a centimetre off along the line of sight, each way in turn.
  std::array frames = {instant(even_motion, 1.0, 1.0), instant(even_motion, 1.00833, 1.0),
                       instant(even_motion, 1.01667, 1.0)};
  for (std::size_t i = 0; i < 3; ++i)
    frames[i].pose = frames[i].pose *
                     Pose(Eigen::Quaterniond::Identity(), Eigen::Vector3d(0.0, 0.0, i == 1 ? 0.005 : -0.005));
  EXPECT_TRUE(path_ratio(frames, MotionNoise()));
}

/// Brownian motion of the velocity, in steps of a thousandth of the span: as much as motion_variance says,
/// for one observation alone.
TEST(PathRatio, KnowsHowMuchTheMotionChangesBetweenFrames) {
  RandomStream random(7);
  const MotionNoise noise;
  constexpr double kSpan_s = 2.0 / 30.0;
  constexpr int kSteps = 1000, kRuns = 2000;
  const double step_s = kSpan_s / kSteps;
  double squares = 0.0;
  int count = 0;
  for (int run = 0; run < kRuns; ++run) {
    std::array<Swing, 3> swings;
    Swing now{0.0, 3.0, 0.0, 2.0};
    swings[0] = now;
    for (int i = 1; i <= kSteps; ++i) {
      const double turn = random.normal() * std::sqrt(noise.angular_rad2_per_s3 * step_s);
      const double push = random.normal() * std::sqrt(noise.linear_m2_per_s3 * step_s);
      now.angle += step_s * (now.angular_speed + 0.5 * turn);
      now.x += step_s * (now.speed + 0.5 * push);
      now.angular_speed += turn;
      now.speed += push;
      if (i % (kSteps / 2) == 0) swings[static_cast<std::size_t>(2 * i / kSteps)] = now;
    }
    const auto swing_at = [&](double t) {
      return swings[static_cast<std::size_t>(std::lround((t - 1.0) / (0.5 * kSpan_s)))];
    };
    const std::array frames = {instant(swing_at, 1.0, 1.0), instant(swing_at, 1.0 + 0.5 * kSpan_s, 1.0),
                               instant(swing_at, 1.0 + kSpan_s, 1.0)};
    const auto seen = path_ratio(frames, noise);
    const auto wilder = path_ratio(frames, {2.0 * noise.linear_m2_per_s3, 2.0 * noise.angular_rad2_per_s3});
    if (!seen || !wilder) continue;  // it hardly moved
    ++count;
    const double off = std::log(seen->ratio);
    squares += off * off / (wilder->variance - seen->variance);  // the motion's share alone
  }
  EXPECT_GT(count, kRuns * 9 / 10);
  EXPECT_NEAR(squares / count, 2.0, 0.3);  // half of the motion noise is usual
}

constexpr PathRatio kFast{.ratio = 1.0, .variance = 0.025};

/// `count` observations of the true factor, a share of them false.
void observe(ExposureEstimate& estimate, double factor, int count, double false_share = 0.0,
             std::uint64_t seed = 1) {
  RandomStream random(seed);
  for (int i = 0; i < count; ++i) {
    PathRatio seen = kFast;
    seen.ratio = factor * std::exp(std::sqrt(seen.variance) * random.normal());
    if (random.uniform(0.0, 1.0) < false_share) seen.ratio = std::exp(random.uniform(-2.5, 1.5));
    estimate.observe(seen);
  }
}

TEST(ExposureEstimate, IsWhatWasToldBeforeAnythingIsSeen) {
  const ExposureEstimate told(0.1);
  EXPECT_EQ(told.factor(), 1.0);
  EXPECT_FALSE(told.has_observed());
  EXPECT_EQ(told.sigma(), 0.1);
}

/// Against the posterior by brute force, of one observation and the prior's two Gaussians.
TEST(ExposureEstimate, IsTheMeanOfThePosterior) {
  for (const double ratio : {0.5, 0.9, 1.3}) {
    ExposureEstimate estimate(0.1);
    PathRatio seen = kFast;
    seen.ratio = ratio;
    estimate.observe(seen);
    double sum = 0.0, first = 0.0;
    for (double log_factor = -3.2; log_factor <= 3.2; log_factor += 1e-4) {
      const double off = std::log(ratio) - log_factor;
      const double prior = 0.97 / 0.1 * std::exp(-50.0 * log_factor * log_factor) +
                           0.03 / 0.7 * std::exp(-0.5 / 0.49 * log_factor * log_factor);
      const double likelihood = 0.9 / std::sqrt(2.0 * std::numbers::pi * seen.variance) *
                                    std::exp(-0.5 * off * off / seen.variance) +
                                0.1 / std::log(100.0);
      sum += prior * likelihood;
      first += prior * likelihood * log_factor;
    }
    EXPECT_NEAR(std::log(estimate.factor()), first / sum, 1e-4) << ratio;
  }
}

TEST(ExposureEstimate, FindsAnUnknownExposure) {
  for (const double factor : {0.15, 0.6, 1.0, 2.4}) {
    ExposureEstimate estimate(0.7);
    observe(estimate, factor, 5);
    EXPECT_NEAR(std::log(estimate.factor() / factor), 0.0, 0.2) << factor;
    observe(estimate, factor, 60, 0.0, 2);
    EXPECT_NEAR(std::log(estimate.factor() / factor), 0.0, 0.05) << factor;
    EXPECT_LT(estimate.sigma(), 0.04);
  }
}

TEST(ExposureEstimate, CorrectsWhatWasToldWrongAndLeavesWhatIsRight) {
  for (const double factor : {0.8, 1.0, 1.2, 1.6}) {
    ExposureEstimate estimate(0.1);
    observe(estimate, factor, 80);
    EXPECT_NEAR(std::log(estimate.factor() / factor), 0.0, 0.05) << factor;
  }
}

TEST(ExposureEstimate, IsNotMovedByOutliers) {
  for (const double factor : {0.5, 1.0, 2.0}) {
    ExposureEstimate estimate(0.7);
    observe(estimate, factor, 100, 0.3);
    EXPECT_NEAR(std::log(estimate.factor() / factor), 0.0, 0.08) << factor;
  }
}

TEST(ExposureEstimate, FollowsTheLight) {
  ExposureEstimate estimate(0.7);
  observe(estimate, 2.0, 300);
  observe(estimate, 0.8, 150, 0.0, 3);
  EXPECT_NEAR(std::log(estimate.factor() / 0.8), 0.0, 0.08);
}

TEST(ExposureEstimate, IsNeverLongerThanItsLimit) {
  ExposureEstimate estimate(0.7);
  estimate.limit(0.4);
  EXPECT_EQ(estimate.factor(), 0.4);
  observe(estimate, 1.0, 20);
  EXPECT_LE(estimate.factor(), 0.4);
}

TEST(ExposureEstimate, PassesOverWhatIsNoRatio) {
  ExposureEstimate estimate(0.7);
  for (const double ratio : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
    PathRatio seen = kFast;
    seen.ratio = ratio;
    estimate.observe(seen);
  }
  EXPECT_FALSE(estimate.has_observed());
  EXPECT_EQ(estimate.factor(), 1.0);
}

}  // namespace
}  // namespace apriltrack::test
