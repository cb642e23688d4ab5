#include "path_bend.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "blur_film.h"

namespace apriltrack::test {
namespace {

TEST(PathBend, IsTheAccelerationOfAnEvenlyAcceleratedMotion) {
  Vector6d before, acceleration;
  before << 0.3, -0.2, 0.1, 1.0, -2.0, 0.5;
  acceleration << 4.0, -3.0, 0.0, 0.0, 6.0, -8.0;
  const Vector6d now = before + acceleration / 40.0;
  const MotionNoise noise{.linear_m2_per_s3 = 10.0, .angular_rad2_per_s3 = 160.0};
  const PathBend bend = expected_bend(now, before, 1.0 / 40.0, noise);
  EXPECT_LT((bend.acceleration - acceleration).norm(), 1e-10);
  // A tenth of sqrt(40 * 10) = 20 and of sqrt(40 * 160) = 80; a fifth of 5 m/s^2 and of 10 rad/s^2, and as
  // much of them as their squares are of 80's and 320's.
  EXPECT_NEAR(bend.sigma[0], std::hypot(2.0, 5.0 * std::hypot(0.2, std::pow(5.0 / 80.0, 2))), 1e-12);
  EXPECT_NEAR(bend.sigma[4], std::hypot(8.0, 10.0 * std::hypot(0.2, std::pow(10.0 / 320.0, 2))), 1e-12);
}

/// Over a hand's shaking, seen every interval_s: the root mean square of what the acceleration is expected to
/// be off by, and of what it is off by.
struct Off {
  double expected = 0.0, found = 0.0;
};

Off off_at(double interval_s) {
  // Turns of three speeds that never repeat together, 70 rad/s^2 at the most.
  const auto velocity = [](double t) { return 1.1 * std::sin(11.0 * t) + 1.3 * std::sin(17.3 * t + 1.0); };
  const auto acceleration = [](double t) {
    return 12.1 * std::cos(11.0 * t) + 22.5 * std::cos(17.3 * t + 1.0);
  };
  Off off;
  constexpr int kInstants = 5000;
  for (int i = 0; i < kInstants; ++i) {
    const double now_s = 0.0317 * i;
    Vector6d now = Vector6d::Zero(), before = Vector6d::Zero();
    now[4] = velocity(now_s);
    before[4] = velocity(now_s - interval_s);
    const PathBend bend = expected_bend(now, before, interval_s, MotionNoise());
    off.expected += bend.sigma[4] * bend.sigma[4] / kInstants;
    off.found += std::pow(bend.acceleration[4] - acceleration(now_s), 2) / kInstants;
  }
  return {std::sqrt(off.expected), std::sqrt(off.found)};
}

TEST(PathBend, KnowsTheLessTheLongerTheFrameBeforeIsGone) {
  for (const double interval_s : {1.0 / 30.0, 1.0 / 15.0, 1.0 / 10.0, 0.2, 0.5}) {
    const Off off = off_at(interval_s);
    EXPECT_LT(off.found, 1.5 * off.expected) << interval_s;
    EXPECT_GT(off.found, 0.5 * off.expected) << interval_s;
  }
}

TEST(PathBend, DoesNotTrustAJump) {
  // Cut from one motion into another: the acceleration may as well be none.
  const Vector6d before = Vector6d::Zero(), now = Vector6d::Constant(20.0);
  const PathBend bend = expected_bend(now, before, 1.0 / 30.0, MotionNoise());
  EXPECT_GT(bend.sigma[0], bend.acceleration.head<3>().norm());
  EXPECT_GT(bend.sigma[3], bend.acceleration.tail<3>().norm());
}

TEST(PathBend, IsUnknownWhereNothingWasSeenBefore) {
  const MotionNoise noise{.linear_m2_per_s3 = 3.0, .angular_rad2_per_s3 = 120.0};
  const Vector6d velocity = Vector6d::Constant(2.0);
  for (const PathBend& bend :
       {expected_bend(velocity, std::nullopt, 0.04, noise), expected_bend(velocity, velocity, {}, noise)})
    EXPECT_EQ(bend.acceleration, Vector6d::Zero());
  EXPECT_NEAR(expected_bend(velocity, std::nullopt, {}, noise).sigma[5], 0.5 * std::sqrt(120.0 * 30.0), 1e-9);
}

TEST(PathBend, ShiftsThePoseByTheMeanOfThePathsBend) {
  constexpr double kExposure_s = 0.02;
  Vector6d sigma;
  sigma << 1.0, 2.0, 3.0, 40.0, 50.0, 60.0;
  constexpr int kInstants = 100'000;
  double mean_s2 = 0.0;  // of t^2 / 2, by brute force
  for (int i = 0; i < kInstants; ++i) {
    const double time_s = kExposure_s * ((i + 0.5) / kInstants - 0.5);
    mean_s2 += 0.5 * time_s * time_s / kInstants;
  }
  const Matrix6d covariance = bend_covariance(sigma, kExposure_s);
  for (int i = 0; i < 6; ++i) {
    EXPECT_NEAR(std::sqrt(covariance(i, i)), mean_s2 * sigma[i], 1e-8 * mean_s2 * sigma[i]);
    for (int k = 0; k < i; ++k) EXPECT_EQ(covariance(i, k), 0.0);
  }
}

TEST(PathBend, KeepsTheCovarianceHonestWhereAMotionTurnsAbout) {
  // Turns within exposures of 24 ms, sharp and blurred; three films of 16 frames, for the mean over one of
  // them is 1.6 to 2.1. The first two frames' velocity is a guess.
  double sum = 0.0, most = 0.0, count = 0.0;
  for (const std::uint64_t seed : {1U, 5U, 7U}) {
    const BlurFilm film = swung_camera_with(seed);
    const std::vector<TrackResult> results = tracked(tracker_of(film, 0, 16), film);
    for (std::size_t i = 2; i < film.size(); ++i) {
      ASSERT_TRUE(has_evidence(results[i])) << "seed " << seed << ", frame " << i;
      const Vector6d xi = (results[i].pose->inverse() * film.frames[i].truth).log();
      const double error = xi.dot(results[i].covariance->inverse() * xi) / 6.0;
      sum += error;
      most = std::max(most, error);
      count += 1.0;
    }
  }
  RecordProperty("mean", std::to_string(sum / count));
  RecordProperty("most", std::to_string(most));
  EXPECT_GT(sum / count, 0.7);
  EXPECT_LT(sum / count, 2.0);
  EXPECT_LT(most, 8.0);
}

}  // namespace
}  // namespace apriltrack::test
