#include "apriltrack/tracker/localizer.h"

#include <gmock/gmock.h>

#include <Eigen/LU>
#include <algorithm>
#include <functional>
#include <limits>

#include "apriltrack/base/error.h"
#include "pose_adjustment.h"
#include "pose_candidate.h"
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

Camera radtan() {
  return test::camera_with(RadtanDistortion({-0.28, 0.09, 0.0005, -0.0003}));
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
  const Camera camera = radtan();
  RandomStream random(303);
  const FrameDetections exact = test::seen(camera, test::room(), Pose());
  const auto sigma_m = [&](double noise_px) {
    Localizer localizer(camera, test::room());
    return std::sqrt(localizer.localize(test::with_noise(exact, random, noise_px)).covariance->trace());
  };
  EXPECT_NEAR(sigma_m(1.0) / sigma_m(0.02), 1.0 / LocalizerOptions().corner_sigma_px, 3.0);
}

TEST(Localizer, SurvivesATagThatTheMapHasAtAWrongPlace) {
  const Camera camera = radtan();
  RandomStream random(304);
  TagMap wrong = test::room();
  wrong.tags[3].T_map_tag =
      wrong.tags[3].T_map_tag * Pose::exp((Vector6d() << 0.1, 0.05, 0, 0, 0.2, 0).finished());
  for (int i = 0; i < 50; ++i) {
    const Pose T_map_camera = test::random_T_map_camera(random);
    Localizer localizer(camera, wrong);
    const TrackResult result = localizer.localize(
        test::with_noise(test::seen(camera, test::room(), T_map_camera.inverse()), random, 0.1));
    ASSERT_EQ(result.status, TrackStatus::kDetected);
    EXPECT_THAT(*result.pose, PoseNear(T_map_camera, 5e-3, 3e-3));
    EXPECT_EQ(result.tags_detected, 7);
    EXPECT_EQ(result.tags_tracked, 6) << "the wrong tag must not be claimed as evidence";
  }
}

TEST(Localizer, TwoTagsThatDisagreeGiveNoPoseUnlessTheMotionSpeaksForOne) {
  const Camera camera = radtan();
  TagMap wrong = test::room();
  wrong.tags[3].T_map_tag =
      wrong.tags[3].T_map_tag * Pose::exp((Vector6d() << 0.3, 0.1, 0, 0, 0.5, 0).finished());
  const TagMap two = test::only(test::room(), {2, 3});
  Localizer fresh(camera, wrong);
  const TrackResult lost = fresh.localize(test::seen(camera, two, Pose()));
  EXPECT_EQ(lost.status, TrackStatus::kLost);
  EXPECT_FALSE(lost.pose);
  EXPECT_FALSE(lost.covariance);
  EXPECT_THAT(lost.reason, testing::HasSubstr("do not agree"));

  Localizer moving(camera, wrong);
  ASSERT_TRUE(moving.localize(test::seen(camera, test::room(), Pose(), {1'000'000'000})).pose);
  const TrackResult result = moving.localize(test::seen(camera, two, Pose(), {1'033'000'000}));
  ASSERT_EQ(result.status, TrackStatus::kDetected) << result.reason;
  EXPECT_THAT(*result.pose, PoseNear(Pose(), 1e-6, 1e-6));
  EXPECT_EQ(result.tags_tracked, 1);
}

/// The map of another place: a pose from two tags that happen to fit must not live on among tags that refute
/// it.
TEST(Localizer, AMinorityOfTagsGivesNoPoseEvenWithTheMotion) {
  const Camera camera = radtan();
  TagMap elsewhere = test::room();
  for (std::size_t i = 2; i < elsewhere.tags.size(); ++i) {
    const double turn = 0.4 + 0.1 * static_cast<double>(i);
    elsewhere.tags[i].T_map_tag =
        elsewhere.tags[i].T_map_tag * Pose::exp((Vector6d() << turn, -turn, 0, 0, turn, 0).finished());
  }
  const TagMap first = test::only(test::room(), {elsewhere.tags[0].key.id, elsewhere.tags[1].key.id});
  Localizer localizer(camera, elsewhere);
  ASSERT_TRUE(localizer.localize(test::seen(camera, first, Pose(), {1'000'000'000})).pose);
  const TrackResult result = localizer.localize(test::seen(camera, test::room(), Pose(), {1'033'000'000}));
  ASSERT_GE(result.tags_detected, 5);
  EXPECT_EQ(result.status, TrackStatus::kLost);
  EXPECT_FALSE(result.pose);
}

/// A lone tag 2.5 m away, tilted by 25 degrees, corners 0.4 px off: the perspective that tells its two poses
/// apart is smaller than the noise.
TEST(Localizer, RecentPosesSettleTheAmbiguityOfALoneTag) {
  const Camera camera = radtan();
  TagMap map = test::room();
  map.tags.push_back(test::tag_at(7, {rotation_exp({0.0, 25 * test::kDegree, 0.0}), {0.1, 0.1, 2.5}}));
  const TagMap lone = test::only(map, {7});
  LocalizerOptions options;
  options.corner_sigma_px = 0.4;
  RandomStream random(305);
  constexpr int kNumRuns = 150;
  int wrong_alone = 0;
  int wrong_with_history = 0;
  int with_second_pose = 0;
  const auto is_wrong = [](const TrackResult& result) {
    return !result.pose || rotation_angle_rad(result.pose->rotation(), Eigen::Quaterniond::Identity()) > 0.35;
  };
  for (int i = 0; i < kNumRuns; ++i) {
    const auto lone_frame = [&](std::int64_t ns) {
      return test::with_noise(test::seen(camera, lone, Pose(), {ns}), random, 0.4);
    };
    Localizer alone(camera, map, options);
    const TrackResult guess = alone.localize(lone_frame(1'000'000'000));
    wrong_alone += is_wrong(guess);
    with_second_pose += guess.second_pose.has_value();
    EXPECT_GE(guess.second_mode_odds, 0.0);
    EXPECT_LE(guess.second_mode_odds, 1.0);

    Localizer with_history(camera, map, options);
    with_history.localize(test::with_noise(test::seen(camera, map, Pose(), {1'000'000'000}), random, 0.4));
    with_history.localize(test::with_noise(test::seen(camera, map, Pose(), {1'033'000'000}), random, 0.4));
    wrong_with_history += is_wrong(with_history.localize(lone_frame(1'066'000'000)));
  }
  EXPECT_GT(wrong_alone, kNumRuns / 10) << "the case must be hard, or it proves nothing";
  EXPECT_GT(with_second_pose, kNumRuns / 2);
  EXPECT_LE(wrong_with_history, kNumRuns / 50);
}

TEST(PoseCandidate, FitsToATagMoreOrLessAreOneExplanation) {
  const Camera camera = radtan();
  RandomStream random(307);
  int same = 0;
  for (int i = 0; i < 100; ++i) {
    const TagMap map = test::room();
    const auto observations = observe_mapped_tags(
        map, camera.model, test::with_noise(test::seen(camera, map, Pose()), random, 0.5).detections);
    std::vector<const TagObservation*> all;
    for (const TagObservation& observation : observations) all.push_back(&observation);
    const RobustKernel kernel{RobustKernel::Shape::kHuber, 1.5};
    const PoseCandidate winner{.T_camera_map = adjust_pose(camera.model, all, kernel, Pose()),
                               .inliers = all,
                               .squared_error_px2 = 0.0};
    const Matrix6d covariance = 0.25 * corner_information(camera.model, all, winner.T_camera_map).inverse();
    const std::vector<const TagObservation*> fewer(all.begin() + 1, all.end());
    same += is_same_explanation(winner.T_camera_map, covariance,
                                adjust_pose(camera.model, fewer, kernel, Pose()));
    const Pose turned = winner.T_camera_map * Pose::exp((Vector6d() << 0, 0, 0, 0, 0.2, 0).finished());
    EXPECT_FALSE(is_same_explanation(winner.T_camera_map, covariance, turned));
  }
  EXPECT_GE(same, 95);
}

TEST(Localizer, GivesTheSameWhetherItWasPreparedOrNot) {
  Camera camera = radtan();
  camera.width = camera.height = 16;
  const TagMap map = test::room();
  const GrayImage image(16, 16);
  const Frame frame{.image = image.view(), .timestamp = {1}, .exposure_s = {}};
  Localizer prepared(camera, map);
  prepared.prepare();
  prepared.prepare();  // once is enough, twice does no harm
  const TrackResult ready = prepared.localize(frame);
  Localizer lazy(camera, map);
  const TrackResult first = lazy.localize(frame);
  EXPECT_EQ(ready.reason, "no tag seen");
  EXPECT_EQ(first.reason, ready.reason);
  EXPECT_EQ(first.status, ready.status);
}

TEST(Localizer, ForgetsPosesThatAreTooOld) {
  // Half a second after a wrong pose has been seen, the corners alone decide again.
  const Camera camera = radtan();
  const TagMap map = test::room();
  const Pose before = Pose::exp((Vector6d() << 0, 0, 0, 0, 0, 0.5).finished());
  Localizer localizer(camera, map);
  ASSERT_TRUE(localizer.localize(test::seen(camera, map, before, {1'000'000'000})).pose);
  const TrackResult result =
      localizer.localize(test::seen(camera, test::only(map, {2}), Pose(), {1'500'000'000}));
  ASSERT_TRUE(result.pose);
  EXPECT_THAT(*result.pose, PoseNear(Pose(), 1e-6, 1e-6));
}

TEST(Localizer, ClearCornersOverruleTheMotionModel) {
  const Camera camera = radtan();
  const TagMap map = test::room();
  const Pose jump = Pose::exp((Vector6d() << 0.2, 0, 0, 0, 0, 1.0).finished());
  Localizer localizer(camera, map);
  localizer.localize(test::seen(camera, map, Pose(), {1'000'000'000}));
  localizer.localize(test::seen(camera, map, Pose(), {1'033'000'000}));
  const TrackResult result = localizer.localize(test::seen(camera, map, jump.inverse(), {1'066'000'000}));
  ASSERT_TRUE(result.pose);
  EXPECT_THAT(*result.pose, PoseNear(jump, 1e-6, 1e-6));
}

TEST(Localizer, OfATagSeenTwiceKeepsTheOneThatFits) {
  const Camera camera = radtan();
  FrameDetections frame = test::seen(camera, test::only(test::room(), {0, 2, 4}), Pose());
  Detection copy = frame.detections[0];
  for (Eigen::Vector2d& corner : copy.corners_px) corner += Eigen::Vector2d(90.0, 60.0);
  frame.detections.insert(frame.detections.begin(), copy);
  Localizer localizer(camera, test::room());
  const TrackResult result = localizer.localize(frame);
  ASSERT_TRUE(result.pose) << result.reason;
  EXPECT_THAT(*result.pose, PoseNear(Pose(), 1e-6, 1e-6));
  EXPECT_EQ(result.tags_detected, 3);
  EXPECT_EQ(result.tags_tracked, 3);

  FrameDetections only_copies = frame;
  only_copies.detections.resize(2);  // tag 0 twice, and nothing else
  Localizer fresh(camera, test::room());
  EXPECT_EQ(fresh.localize(only_copies).status, TrackStatus::kLost) << "either may be the false one";
}

TEST(Localizer, SaysWhyThereIsNoPose) {
  const Camera camera = radtan();
  Localizer localizer(camera, test::only(test::room(), {0, 1}));
  EXPECT_EQ(localizer.localize(FrameDetections{}).reason, "no tag seen");
  const TrackResult unmapped = localizer.localize(test::seen(camera, test::only(test::room(), {5}), Pose()));
  EXPECT_EQ(unmapped.status, TrackStatus::kLost);
  EXPECT_EQ(unmapped.tags_detected, 0);
  EXPECT_EQ(unmapped.reason, "no tag of the map seen");

  // One edge looks three times as long as the one across: a square of 0.16 m would have to reach 0.5 m in
  // depth.
  FrameDetections bent = test::seen(camera, test::only(test::room(), {0}), Pose());
  bent.detections[0].corners_px = {Eigen::Vector2d(250, 300), {350, 300}, {450, 100}, {150, 100}};
  const TrackResult lost = localizer.localize(bent);
  EXPECT_EQ(lost.status, TrackStatus::kLost);
  EXPECT_EQ(lost.reason, "the corners seen fit no pose");
}

TEST(Localizer, NoDetectionWhateverGivesANaNOrAnException) {
  const Camera camera = radtan();
  RandomStream random(306);
  Localizer localizer(camera, test::room());
  int num_poses = 0;
  for (int i = 0; i < 2000; ++i) {
    FrameDetections frame;
    frame.timestamp = {static_cast<std::int64_t>(random.uniform(0.0, 1e9))};  // backwards, too
    const int num_tags = static_cast<int>(random.uniform(0.0, 5.0));
    const double spread_px = std::pow(10.0, random.uniform(-6.0, 3.0));
    for (int k = 0; k < num_tags; ++k) {
      Detection detection{.tag = {"tag36h11", static_cast<int>(random.uniform(0.0, 7.0))},
                          .corners_px = {},
                          .hamming = {},
                          .decision_margin = {}};
      const Eigen::Vector2d centre(random.uniform(0.0, 640.0), random.uniform(0.0, 480.0));
      for (Eigen::Vector2d& corner : detection.corners_px) {
        corner = centre + spread_px * Eigen::Vector2d(random.normal(), random.normal());
      }
      if (i % 50 == 0) detection.corners_px[1].x() = std::numeric_limits<double>::quiet_NaN();
      frame.detections.push_back(detection);
    }
    const TrackResult result = localizer.localize(frame);
    EXPECT_EQ(result.pose.has_value(), result.status == TrackStatus::kDetected);
    EXPECT_EQ(result.pose.has_value(), result.reason.empty());
    if (!result.pose) continue;
    EXPECT_TRUE(result.pose->is_finite());
    EXPECT_TRUE(result.covariance->allFinite());
    ++num_poses;
  }
  EXPECT_GT(num_poses, 20) << "some random quads are tags";
}

TEST(Localizer, RefusesAMapWithoutTagsAndUnknownFamilies) {
  EXPECT_THROW(Localizer(radtan(), TagMap()), Error);
  TagMap map = test::room();
  map.tags[2].key.family = "tag99h1";
  try {
    Localizer localizer(radtan(), map);
    FAIL() << "an unknown family must be refused";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kInvalidInput);
    EXPECT_THAT(error.what(), testing::HasSubstr("tag99h1/2"));
    EXPECT_THAT(error.what(), testing::HasSubstr("tag36h11"));
  }
}

/// A map that a program made: what tags/ refuses in files, it must not pass here.
TEST(Localizer, RefusesAMapWithValuesThatNoFileMayHave) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<std::pair<std::string, std::function<void(TagMap&)>>> spoilers = {
      {"tag36h11/2: size_m: must be > 0 and at most 100 (is nan)",
       [&](TagMap& m) { m.tags[2].size_m = nan; }},
      {"tag36h11/2: size_m: must be > 0 and at most 100 (is 0)", [](TagMap& m) { m.tags[2].size_m = 0.0; }},
      {"tag36h11/2: size_m", [](TagMap& m) { m.tags[2].size_m = -0.16; }},
      {"tag36h11/2: T_map_tag",
       [&](TagMap& m) {
         m.tags[2].T_map_tag = Pose(Eigen::Quaterniond::Identity(), {nan, 0.0, 0.0});
       }},
      {"tag36h11/2: covariance", [&](TagMap& m) { m.tags[2].covariance = Matrix6d::Constant(nan); }},
      {"tag36h11/2: covariance", [](TagMap& m) { m.tags[2].covariance = -Matrix6d::Identity(); }},
      {"tag36h11/900: id", [](TagMap& m) { m.tags[2].key.id = 900; }},
      {"tag36h11/2 is in it twice", [](TagMap& m) { m.tags.push_back(m.tags[2]); }}};
  for (const auto& [message, spoil] : spoilers) {
    TagMap map = test::room();
    spoil(map);
    try {
      Localizer localizer(radtan(), map);
      ADD_FAILURE() << "not refused: " << message;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kInvalidInput);
      EXPECT_THAT(error.what(), testing::HasSubstr(message));
    }
  }
}

/// A lone tag after a moving pose: its covariance rests on the blur, and so on the exposure.
TEST(Localizer, AnExposureThatCannotBeIsAsIfItWereNotTold) {
  Camera camera = radtan();
  camera.exposure_s = std::nullopt;
  const Pose before = Pose::exp((Vector6d() << 0.05, 0, 0, 0, 0, 0.1).finished());
  const auto sigma_with = [&](std::optional<double> exposure_s, std::optional<double> of_camera_s) {
    camera.exposure_s = of_camera_s;
    Localizer localizer(camera, test::room());
    localizer.localize(test::seen(camera, test::room(), before, {1'000'000'000}));
    const TrackResult result = localizer.localize(
        test::seen(camera, test::only(test::room(), {2}), Pose(), {1'033'000'000}), exposure_s);
    EXPECT_TRUE(result.pose && result.covariance->allFinite()) << result.reason;
    return result.pose ? std::sqrt(result.covariance->trace()) : 0.0;
  };
  const double not_told = sigma_with(std::nullopt, std::nullopt);
  const double of_camera = sigma_with(std::nullopt, 0.03);
  ASSERT_GT(of_camera, 1.5 * not_told) << "the exposure must matter, or this proves nothing";
  ASSERT_LT(sigma_with(0.0, std::nullopt), 0.7 * not_told);
  for (const double odd_s :
       {std::numeric_limits<double>::quiet_NaN(), -0.03, -1e300, std::numeric_limits<double>::infinity()}) {
    EXPECT_EQ(sigma_with(odd_s, std::nullopt), not_told) << odd_s;
    EXPECT_EQ(sigma_with(odd_s, 0.03), of_camera) << odd_s;
    EXPECT_EQ(sigma_with(std::nullopt, odd_s), not_told) << odd_s;
  }
}

TEST(Localizer, RefusesOptionsOutOfRange) {
  LocalizerOptions options;
  options.corner_sigma_px = 0.0;
  EXPECT_THROW(options.check(), Error);
  options = {};
  options.max_residual_rms_px = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(options.check(), Error);
  EXPECT_NO_THROW(LocalizerOptions().check());
}

TEST(Localizer, AnImageOfAnotherResolutionIsLostAndSaysBothSizes) {
  Localizer localizer(radtan(), test::room());
  const GrayImage image(320, 240);
  const TrackResult result =
      localizer.localize(Frame{.image = image.view(), .timestamp = {77}, .exposure_s = {}});
  EXPECT_EQ(result.status, TrackStatus::kLost);
  EXPECT_FALSE(result.pose);
  EXPECT_EQ(result.timestamp, Timestamp{77});
  EXPECT_THAT(result.reason, testing::HasSubstr("320 x 240"));
  EXPECT_THAT(result.reason, testing::HasSubstr("640 x 480"));
  // The next frame is none the worse for it.
  EXPECT_EQ(localizer.localize(test::seen(radtan(), test::room(), Pose())).status, TrackStatus::kDetected);
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
