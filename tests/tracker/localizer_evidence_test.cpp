#include <gmock/gmock.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

#include "apriltrack/tracker/localizer.h"
#include "pose_adjustment.h"
#include "pose_candidate.h"
#include "support/pose_matchers.h"
#include "synthetic_world.h"

namespace apriltrack {
namespace {

using test::PoseNear;

TEST(Localizer, SurvivesATagThatTheMapHasAtAWrongPlace) {
  const Camera camera = test::radtan();
  RandomStream random(304);
  TagMap wrong = test::room();
  wrong.tags[3].T_map_tag =
      wrong.tags[3].T_map_tag * Pose::exp((Vector6d() << 0.1, 0.05, 0, 0, 0.2, 0).finished());
  constexpr int kPoses = 50;
  double sum_chi2 = 0.0;
  for (int i = 0; i < kPoses; ++i) {
    const Pose T_map_camera = test::random_T_map_camera(random);
    Localizer localizer(camera, wrong);
    const TrackResult result = localizer.localize(
        test::with_noise(test::seen(camera, test::room(), T_map_camera.inverse()), random, 0.1));
    ASSERT_EQ(result.status, TrackStatus::kDetected);
    const Vector6d error = (result.pose->inverse() * T_map_camera).log();
    const double chi2 = error.dot(result.covariance->ldlt().solve(error));
    EXPECT_LT(chi2, 30.0);  // of 6 degrees of freedom: once in 25,000 poses
    sum_chi2 += chi2;
    EXPECT_EQ(result.tags_detected, 7);
    EXPECT_EQ(result.tags_tracked, 6) << "the wrong tag must not be claimed as evidence";
  }
  const double scatter = std::sqrt(2.0 / 6.0 / kPoses);
  EXPECT_NEAR(sum_chi2 / 6.0 / kPoses, 1.0, 4.0 * scatter);
}

TEST(Localizer, TwoTagsThatDisagreeGiveNoPoseUnlessTheMotionSpeaksForOne) {
  const Camera camera = test::radtan();
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

/// The map with all its tags of a family, and further ones elsewhere.
TagMap of_family(TagMap map, const std::string& family, int num_elsewhere) {
  for (int i = 0; i < num_elsewhere; ++i)
    map.tags.push_back(test::tag_at(10 + i, Pose(Eigen::Quaterniond::Identity(), {0.0, 0.0, 20.0 + i})));
  for (MapTag& tag : map.tags) tag.key.family = family;
  return map;
}

/// Whether one of the room's tags, alone in the frame, is claimed.
TrackResult of_lone_tag(const std::string& family, int num_mapped, int corrected_bits) {
  const Camera camera = test::radtan();
  const TagMap one = test::only(test::room(), {1});
  FrameDetections frame = test::seen(camera, of_family(one, family, 0), Pose());
  frame.detections.at(0).hamming = corrected_bits;
  Localizer localizer(camera, of_family(one, family, num_mapped - 1));
  return localizer.localize(frame);
}

TEST(Localizer, ALoneTagThatChanceMayReadGivesNoPose) {
  const TrackResult result = of_lone_tag("tag16h5", 7, 0);
  EXPECT_EQ(result.status, TrackStatus::kLost);
  EXPECT_FALSE(result.pose);
  EXPECT_EQ(result.tags_detected, 1);
  EXPECT_THAT(result.reason, testing::HasSubstr("chance may read it"));
  EXPECT_FALSE(of_lone_tag("tag16h5", 2, 0).pose);
  EXPECT_FALSE(of_lone_tag("tag16h5", 1, 1).pose);
  EXPECT_TRUE(of_lone_tag("tag16h5", 1, 0).pose) << "nothing else could confirm it";
  EXPECT_FALSE(of_lone_tag("tag25h9", 20, 2).pose);
}

TEST(Localizer, ALoneTagOfManyBitsGivesAPoseInAnyMapOfARoom) {
  for (const int corrected_bits : {0, 1, 2}) {
    EXPECT_TRUE(of_lone_tag("tag36h11", 1, corrected_bits).pose);
    EXPECT_TRUE(of_lone_tag("tag36h11", 270, corrected_bits).pose);
  }
  EXPECT_TRUE(of_lone_tag("tag36h11", 577, 1).pose);
  EXPECT_FALSE(of_lone_tag("tag36h11", 577, 2).pose);
}

TEST(Localizer, TagsOfFewBitsThatAgreeGiveAPose) {
  const Camera camera = test::radtan();
  const TagMap two = of_family(test::only(test::room(), {1, 2}), "tag16h5", 0);
  Localizer localizer(camera, of_family(test::room(), "tag16h5", 0));
  const TrackResult result = localizer.localize(test::seen(camera, two, Pose()));
  ASSERT_EQ(result.status, TrackStatus::kDetected) << result.reason;
  EXPECT_THAT(*result.pose, PoseNear(Pose(), 1e-6, 1e-6));
  // Nor does the motion that they showed make one of them alone any surer.
  const TagMap one = test::only(two, {1});
  EXPECT_FALSE(localizer.localize(test::seen(camera, one, Pose(), {1'033'000'000})).pose);
}

/// The room's tags, all of tag16h5 but those of these ids.
TagMap room_of_few_bits_but(std::initializer_list<int> ids) {
  TagMap map = test::room();
  for (MapTag& tag : map.tags) {
    if (std::ranges::count(ids, tag.key.id) == 0) tag.key.family = "tag16h5";
  }
  return map;
}

/// Tags of the map as seen from its origin; and the picture of the tag `looks_like` read as `read_as`.
FrameDetections with_mistake(const TagMap& map, std::initializer_list<int> ids, int looks_like, int read_as) {
  const Camera camera = test::radtan();
  FrameDetections frame = test::seen(camera, test::only(map, ids), Pose());
  Detection mistake = test::seen(camera, test::only(map, {looks_like}), Pose()).detections.at(0);
  mistake.tag = test::only(map, {read_as}).tags.at(0).key;
  frame.detections.push_back(mistake);
  return frame;
}

TEST(Localizer, WhatChanceMayReadDoesNotOutvoteATagReadForSure) {
  const TagMap map = room_of_few_bits_but({1});
  Localizer localizer(test::radtan(), map);
  const TrackResult result = localizer.localize(with_mistake(map, {1}, 5, 3));
  ASSERT_EQ(result.status, TrackStatus::kDetected) << result.reason;
  EXPECT_EQ(result.tags_detected, 2);
  EXPECT_EQ(result.tags_tracked, 1);
  EXPECT_THAT(*result.pose, PoseNear(Pose(), 1e-6, 1e-6));
}

TEST(Localizer, AccusesNoTagThatChanceMayHaveRead) {
  for (const auto& [map, accused] :
       {std::pair(room_of_few_bits_but({0, 1, 2}), std::vector<TagKey>{}),
        std::pair(room_of_few_bits_but({0, 1, 2, 3}), std::vector<TagKey>{{"tag36h11", 3}})}) {
    Localizer localizer(test::radtan(), map);
    const TrackResult result = localizer.localize(with_mistake(map, {0, 1, 2}, 5, 3));
    ASSERT_EQ(result.tags_tracked, 3) << result.reason;
    EXPECT_EQ(result.contradicting_tags, accused);
  }
}

TEST(Localizer, TagsOfFewBitsThatAgreeGiveNoPoseAmongMoreThatDoNot) {
  TagMap elsewhere = room_of_few_bits_but({});
  for (std::size_t i = 2; i < elsewhere.tags.size(); ++i) {
    const double turn = 0.4 + 0.1 * static_cast<double>(i);
    elsewhere.tags[i].T_map_tag =
        elsewhere.tags[i].T_map_tag * Pose::exp((Vector6d() << turn, -turn, 0, 0, turn, 0).finished());
  }
  Localizer localizer(test::radtan(), elsewhere);
  EXPECT_FALSE(localizer.localize(test::seen(test::radtan(), room_of_few_bits_but({}), Pose())).pose);
}

/// The map of another place: a pose from two tags that happen to fit must not live on among tags that refute
/// it.
TEST(Localizer, AMinorityOfTagsGivesNoPoseEvenWithTheMotion) {
  const Camera camera = test::radtan();
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
  const Camera camera = test::radtan();
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
  const Camera camera = test::radtan();
  RandomStream random(307);
  int same = 0;
  for (int i = 0; i < 100; ++i) {
    const TagMap map = test::room();
    const auto observations =
        observe_mapped_tags(map, TagIndex(map), camera.model,
                            test::with_noise(test::seen(camera, map, Pose()), random, 0.5).detections, 1.0);
    std::vector<const TagObservation*> all;
    for (const TagObservation& observation : observations) all.push_back(&observation);
    const RobustKernel kernel{RobustKernel::Shape::kHuber, 1.5};
    const PoseCandidate winner{
        .T_camera_map = adjust_pose(camera.model, all, kernel, Pose()), .inliers = all, .squared_error = 0.0};
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
  Camera camera = test::radtan();
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
  const Camera camera = test::radtan();
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
  const Camera camera = test::radtan();
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
  const Camera camera = test::radtan();
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

}  // namespace
}  // namespace apriltrack
