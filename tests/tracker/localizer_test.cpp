#include "apriltrack/tracker/localizer.h"

#include <gmock/gmock.h>

#include <Eigen/LU>

#include "support/pose_matchers.h"
#include "synthetic_world.h"

namespace apriltrack {
namespace {

using test::PoseNear;

LocalizerOptions options_for(TrackMode mode) {
  LocalizerOptions options;
  options.mode = mode;
  return options;
}

Pose reported(TrackMode mode, const Pose& T_map_camera) {
  return mode == TrackMode::kEgo ? T_map_camera : T_map_camera.inverse();
}

struct Case {
  std::string name;
  TrackMode mode;
  Distortion distortion;
};

void PrintTo(const Case& parameters, std::ostream* out) {
  *out << parameters.name;
}

class EveryModeAndLens : public testing::TestWithParam<Case> {};

INSTANTIATE_TEST_SUITE_P(
    Localizer, EveryModeAndLens,
    testing::Values(
        Case{"EgoNone", TrackMode::kEgo, NoDistortion{}},
        Case{"EgoRadtan", TrackMode::kEgo, RadtanDistortion({-0.28, 0.09, 5e-4, -3e-4})},
        Case{"EgoEquidistant", TrackMode::kEgo, EquidistantDistortion({0.02, -0.01, 0.003, -0.001})},
        Case{"JointRadtan", TrackMode::kJoint, RadtanDistortion({-0.28, 0.09, 5e-4, -3e-4})},
        Case{"JointEquidistant", TrackMode::kJoint, EquidistantDistortion({0.02, -0.01, 0.003, -0.001})}),
    [](const auto& test_case) { return test_case.param.name; });

TEST_P(EveryModeAndLens, ExactCornersGiveTheExactPose) {
  const Camera camera = test::camera_with(GetParam().distortion);
  RandomStream random(301);
  for (int i = 0; i < 50; ++i) {
    const Pose T_map_camera = test::random_T_map_camera(random);
    Localizer localizer(camera, test::room(), options_for(GetParam().mode));
    const TrackResult result = localizer.localize(test::seen(camera, test::room(), T_map_camera.inverse()));
    ASSERT_EQ(result.status, TrackStatus::kDetected) << result.reason;
    EXPECT_THAT(*result.pose, PoseNear(reported(GetParam().mode, T_map_camera), 1e-7, 1e-7));
    EXPECT_EQ(result.tags_detected, 7);
    EXPECT_EQ(result.tags_tracked, 7);
    EXPECT_EQ(result.second_mode_odds, 0.0);
    EXPECT_FALSE(result.second_pose);
    EXPECT_TRUE(result.reason.empty());
    EXPECT_EQ(result.timestamp, Timestamp{1'000'000'000});
  }
}

/// Mean of xi' inverse(covariance) xi / 6 over many noisy frames, truth = reported * exp(xi): 1 if the
/// covariance is what it says, in the frame it says.
double normalised_error(const Case& parameters, const TagMap& map, double sigma_px, int num_frames) {
  const Camera camera = test::camera_with(parameters.distortion);
  LocalizerOptions options = options_for(parameters.mode);
  options.corner_sigma_px = sigma_px;
  RandomStream random(302);
  double sum = 0.0;
  for (int i = 0; i < num_frames; ++i) {
    const Pose T_map_camera = test::random_T_map_camera(random);
    Localizer localizer(camera, map, options);
    const TrackResult result = localizer.localize(
        test::with_noise(test::seen(camera, map, T_map_camera.inverse()), random, sigma_px));
    if (!result.pose) {
      ADD_FAILURE() << "frame " << i << ": " << result.reason;
      return 0.0;
    }
    const Vector6d xi = (result.pose->inverse() * reported(parameters.mode, T_map_camera)).log();
    sum += xi.dot(result.covariance->llt().solve(xi)) / 6.0;
  }
  return sum / num_frames;
}

TEST_P(EveryModeAndLens, CovarianceIsTheScatterOfThePose) {
  // 300 samples of a chi-squared variable with 6 degrees of freedom, over 6: its mean scatters by 0.033.
  // Sigma is never taken below the expected one, so that the result lies a little under 1.
  const double error = normalised_error(GetParam(), test::room(), 0.3, 300);
  EXPECT_GT(error, 0.82);
  EXPECT_LT(error, 1.10);
}

TEST_P(EveryModeAndLens, CovarianceOfALoneTagIsTheScatterOfItsPose) {
  TagMap lone = test::only(test::room(), {4});  // 1.7 m away and strongly tilted: no ambiguity
  lone.tags[0].T_map_tag = Pose(rotation_exp({-0.8, 0.2, 0.0}), {0.0, 0.1, 0.7});
  const double error = normalised_error(GetParam(), lone, 0.1, 300);
  EXPECT_GT(error, 0.70);
  EXPECT_LT(error, 1.15);
}

TEST(Localizer, ResidualsLargerThanExpectedWidenTheCovariance) {
  const Camera camera = test::radtan();
  RandomStream random(303);
  const FrameDetections exact = test::seen(camera, test::room(), Pose());
  const auto sigma_m = [&](double noise_px) {
    Localizer localizer(camera, test::room());
    return std::sqrt(localizer.localize(test::with_noise(exact, random, noise_px)).covariance->trace());
  };
  EXPECT_NEAR(sigma_m(1.0) / sigma_m(0.02), 1.0 / LocalizerOptions().corner_sigma_px, 3.0);
}

TEST(TrackStatus, HasTheWordsOfTheFrameLog) {
  EXPECT_EQ(to_string(TrackStatus::kDetected), "detected");
  EXPECT_EQ(to_string(TrackStatus::kTracked), "tracked");
  EXPECT_EQ(to_string(TrackStatus::kPredicted), "predicted");
  EXPECT_EQ(to_string(TrackStatus::kLost), "lost");
  EXPECT_EQ(to_string(TrackStatus::kUnreadable), "unreadable");
}

}  // namespace
}  // namespace apriltrack
