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
  acceleration << 4.0, -3.0, 0.0, 0.0, 60.0, -80.0;
  const Vector6d now = before + 0.05 * acceleration;
  const MotionNoise noise{.linear_m2_per_s3 = 5.0, .angular_rad2_per_s3 = 80.0};
  const PathBend bend = expected_bend(now, before, 0.05, noise);
  EXPECT_LT((bend.acceleration - acceleration).norm(), 1e-10);
  // A fifth of 5 m/s^2 and of 100 rad/s^2; a tenth of sqrt(5 / 0.05) = 10 and of sqrt(80 / 0.05) = 40.
  EXPECT_NEAR(bend.sigma[0], std::sqrt(1.0 * 1.0 + 1.0 * 1.0), 1e-12);
  EXPECT_NEAR(bend.sigma[4], std::sqrt(20.0 * 20.0 + 4.0 * 4.0), 1e-12);
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
