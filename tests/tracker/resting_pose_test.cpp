#include "resting_pose.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <vector>

#include "apriltrack/base/random.h"
#include "apriltrack/geometry/rotation.h"
#include "blur_film.h"

namespace apriltrack {
namespace {

const Pose kPose(rotation_exp({0.4, -0.7, 0.2}), {1.0, -0.5, 2.0});

/// Far from a multiple of unity: a lone tag's depth and tilt are tied, and worse known than the rest.
Matrix6d frame_covariance() {
  Matrix6d root = Matrix6d::Identity();
  root.diagonal() << 1e-4, 2e-4, 3e-3, 2e-3, 1e-3, 5e-5;
  root(2, 3) = 1e-3;
  root(4, 0) = 5e-4;
  return root * root.transpose();
}

class Frames {
 public:
  explicit Frames(std::uint64_t run) : random_(31, run) {}

  /// `truth` with a frame's noise.
  Pose next(const Pose& truth) {
    Vector6d noise;
    for (double& value : noise) value = random_.normal();
    return truth * Pose::exp(root_ * noise);
  }

 private:
  RandomStream random_;
  Matrix6d root_ = frame_covariance().llt().matrixL();
};

/// In standard deviations of one frame, all six numbers together.
double sigmas(const Pose& from, const Pose& to) {
  const Vector6d off = (from.inverse() * to).log();
  return std::sqrt(off.dot(frame_covariance().ldlt().solve(off)));
}

TEST(RestingPose, IsTheMeanOfSomeTwentyFrames) {
  constexpr int kNumRuns = 300, kNumFrames = 60;
  // Of a scalar filter whose state wanders by 0.1 of the noise: P = (P + 0.01) / (P + 1.01) has the gain
  // 0.095, and what it gives of independent frames has the variance K / (2 - K) of theirs.
  const double before = 0.5 * (0.01 + std::sqrt(0.01 * 0.01 + 0.04));
  const double gain = before / (before + 1.0);
  double square = 0.0;
  int num_rested = 0;
  for (int run = 0; run < kNumRuns; ++run) {
    Frames frames(static_cast<std::uint64_t>(run));
    RestingPose resting;
    std::optional<Pose> mean;
    for (int frame = 0; frame < kNumFrames; ++frame)
      mean = resting.add(frames.next(kPose), frame_covariance());
    if (!mean) continue;  // started anew of late: one frame in a thousand, and drifts by chance
    ++num_rested;
    square += std::pow(sigmas(kPose, *mean), 2) / 6.0;
  }
  EXPECT_GT(num_rested, 0.9 * kNumRuns);
  EXPECT_NEAR(square / num_rested, gain / (2.0 - gain), 0.015);
}

TEST(RestingPose, IsNoneBeforeAFewFramesAgree) {
  Frames frames(1);
  RestingPose resting;
  for (int frame = 0; frame < 4; ++frame) EXPECT_FALSE(resting.add(frames.next(kPose), frame_covariance()));
  EXPECT_TRUE(resting.add(frames.next(kPose), frame_covariance()));
  resting.forget();
  EXPECT_FALSE(resting.add(frames.next(kPose), frame_covariance()));
}

TEST(RestingPose, IsNoneOfWhatMoves) {
  Frames frames(2);
  RestingPose resting;
  Pose truth = kPose;
  for (int frame = 0; frame < 50; ++frame) {
    truth = truth * Pose(Eigen::Quaterniond::Identity(), Eigen::Vector3d(2e-3, 0.0, 0.0));
    EXPECT_FALSE(resting.add(frames.next(truth), frame_covariance())) << frame;
  }
}

TEST(RestingPose, LetsGoAtOnceWhereAFrameIsElsewhere) {
  Frames frames(3);
  RestingPose resting;
  for (int frame = 0; frame < 30; ++frame) resting.add(frames.next(kPose), frame_covariance());
  const Pose elsewhere = kPose * Pose(Eigen::Quaterniond::Identity(), Eigen::Vector3d(2e-3, 0.0, 0.0));
  EXPECT_FALSE(resting.add(frames.next(elsewhere), frame_covariance()));
}

/// What drifts by a fraction of the noise from frame to frame looks at rest for a while.
TEST(RestingPose, LagsBehindADriftByLittle) {
  for (const double drift : {0.05, 0.1, 0.3, 1.0}) {
    double square = 0.0;
    constexpr int kNumFrames = 300;
    Frames frames(4);
    RestingPose resting;
    Pose truth = kPose;
    for (int frame = 0; frame < kNumFrames; ++frame) {
      truth = truth * Pose(Eigen::Quaterniond::Identity(),
                           Eigen::Vector3d(0.0, drift * std::sqrt(frame_covariance()(1, 1)), 0.0));
      const Pose seen = frames.next(truth);
      const auto mean = resting.add(seen, frame_covariance());
      square += std::pow(sigmas(truth, mean ? *mean : seen), 2) / 6.0;
    }
    EXPECT_LT(square / kNumFrames, 1.1) << "no worse than single frames; drift " << drift;
  }
}

TEST(RestingPose, IsNoneWhereACovarianceIsNone) {
  RestingPose resting;
  for (int frame = 0; frame < 10; ++frame) EXPECT_FALSE(resting.add(kPose, Matrix6d::Constant(std::nan(""))));
  Frames frames(5);
  for (int frame = 0; frame < 10; ++frame) {
    const auto mean = resting.add(frames.next(kPose), frame_covariance());
    EXPECT_EQ(mean.has_value(), frame >= 4) << "what was no number is forgotten";
  }
}

/// Of vectors about their mean.
double scatter(const std::vector<Eigen::Vector3d>& places) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& place : places) mean += place / static_cast<double>(places.size());
  double square = 0.0;
  for (const Eigen::Vector3d& place : places) square += (place - mean).squaredNorm();
  return std::sqrt(square / static_cast<double>(places.size()));
}

/// The first ten frames of thirty are for coming to rest.
TEST(RestingPose, OfAStillTagJittersLessThanAnyFramesOwn) {
  const test::BlurFilm& film = test::still_tag();
  BlurTracker tracker = test::tracker_of(film);
  std::vector<Eigen::Vector3d> places, places_alone;
  double normalised = 0.0;
  for (std::size_t i = 0; i < film.size(); ++i) {
    const TrackResult result = tracker.track(film.frames[i].frame(), film.detections[i]);
    BlurTracker newcomer = test::tracker_of(film);
    const TrackResult alone = newcomer.track(film.frames[i].frame(), film.detections[i]);
    ASSERT_TRUE(result.pose && alone.pose) << i;
    if (i < 10) continue;
    places.push_back(result.pose->translation());
    places_alone.push_back(alone.pose->translation());
    const Vector6d off = (result.pose->inverse() * film.frames[i].truth).log();
    normalised += off.dot(result.covariance->ldlt().solve(off)) / 6.0 / 20.0;
  }
  EXPECT_LT(scatter(places), 0.5 * scatter(places_alone));
  EXPECT_LT(normalised, 2.0) << "what all frames err alike by is still told";
}

}  // namespace
}  // namespace apriltrack
