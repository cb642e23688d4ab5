// Weak directions and advice, in worlds whose weakness is known by construction.
#include "apriltrack/calib/assess_map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "assess/picture_equations.h"
#include "calibrating.h"
#include "model/corner_views.h"
#include "uncertainty/joint_tag_covariance.h"

namespace apriltrack {
namespace {

using test::looking_along;
using test::SyntheticWorld;
using test::tag36h11;
using testing::HasSubstr;

/// Four tags in a square on a wall, and a fifth (id 4) beside them. x along the wall, z up, y into it.
SyntheticWorld wall_of_five() {
  SyntheticWorld world;
  world.rig.cameras.push_back(test::perspective_camera());
  for (const double z : {0.0, 0.4}) {
    for (const double x : {0.0, 0.4}) test::add_tag(world, 0.16, looking_along({x, 0.0, z}, {0.0, 1.0, 0.0}));
  }
  test::add_tag(world, 0.16, looking_along({2.4, 0.0, 0.2}, {0.0, 1.0, 0.0}));
  return world;
}

void look(SyntheticWorld& world, const Eigen::Vector3d& from, const Eigen::Vector3d& at) {
  world.T_world_rig.push_back(looking_along(from, at - from));
}

/// The four from all sides and near: they know each other well. The fifth is out of these pictures.
void look_at_the_four(SyntheticWorld& world) {
  for (int i = 0; i < 24; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / 24.0;
    look(world, {0.2 + 0.6 * std::cos(angle), -0.7, 0.2 + 0.5 * std::sin(angle)}, {0.05, 0.0, 0.2});
  }
}

CalibrationResult calibrate_noisy(const SyntheticWorld& world, std::uint64_t seed,
                                  const CalibrationOptions& options = {}) {
  std::vector<FrameDetections> frames = test::exact_detections(world);
  RandomStream random(seed);
  test::add_edge_noise(frames, 0.15, -0.45, random);
  return test::calibrate(world, frames, options);
}

MapAssessment assess(const CalibrationResult& result) {
  return assess_map(result.map, result.evidence.joint, result.evidence, result.rig);
}

const WeakDirection& direction_of(const MapAssessment& assessment, int id) {
  return *std::ranges::find(assessment.directions, tag36h11(id), &WeakDirection::tag);
}

TEST(WeakDirections, NameTheTiltOfATagSeenHeadOnFromAfar) {
  SyntheticWorld world = wall_of_five();
  look_at_the_four(world);
  for (int i = 0; i < 6; ++i) look(world, {2.4 + 0.05 * i, -4.5, 0.2 + 0.02 * i}, {1.4, 0.0, 0.2});
  const CalibrationResult result = calibrate_noisy(world, 5);
  ASSERT_EQ(result.map.tags.size(), 5u);
  const MapAssessment assessment = assess(result);
  ASSERT_EQ(assessment.directions.size(), 5u);
  const WeakDirection& weak = direction_of(assessment, 4);
  EXPECT_TRUE(weak.is_weak) << weak.words;
  EXPECT_TRUE(weak.is_rotation);
  EXPECT_LT(std::abs(weak.axis.z()), 0.2) << "turns within its plane are seen well";
  EXPECT_THAT(weak.words, HasSubstr("rotation about"));
  EXPECT_THAT(weak.words, HasSubstr("6 frames, all head-on"));
  EXPECT_THAT(weak.words, HasSubstr("all from 4."));
  EXPECT_THAT(weak.words, HasSubstr("in 6 frames"));
  for (int id = 0; id < 4; ++id) EXPECT_FALSE(direction_of(assessment, id).is_weak) << id;
}

/// Two tags that one moment shows, and errors of the second one alone, each along an axis of its own.
struct TwoTags {
  TagMap map;
  JointCovariance joint;
  MapEvidence evidence;

  explicit TwoTags(const Vector6d& variances_of_second) {
    const Pose T_map_second(
        Eigen::Quaterniond(Eigen::AngleAxisd(1.1, Eigen::Vector3d(0.5, -0.7, 0.3).normalized())),
        Eigen::Vector3d(1.0, 0.4, -0.3));
    for (const int id : {0, 1}) {
      MapTag tag;
      tag.key = tag36h11(id);
      tag.size_m = 0.16;
      tag.T_map_tag = id == 0 ? Pose() : T_map_second;
      map.tags.push_back(tag);
      joint.tags.push_back(tag.key);
      MappedView view;
      view.tag = id;
      view.T_camera_tag = Pose(Eigen::Quaterniond::Identity(), Eigen::Vector3d(0.0, 0.0, 2.0));
      view.corners_px = {Eigen::Vector2d(0, 80), {80, 80}, {80, 0}, {0, 0}};
      view.residuals_px.fill(Eigen::Vector2d::Zero());
      view.whitened.setZero();
      evidence.views.push_back(view);
    }
    evidence.moments.resize(1);
    joint.by_noise = Eigen::MatrixXd::Zero(12, 12);
    joint.by_noise.diagonal().tail<6>() = variances_of_second;
    joint.by_errors = Eigen::MatrixXd::Zero(12, 16);
  }

  WeakDirection of_second() const {
    CameraRig rig;
    rig.cameras.push_back(test::perspective_camera());
    return direction_of(assess_map(map, joint, evidence, rig), 1);
  }
};

TEST(WeakDirections, AreInTheTagsOwnAxes) {
  constexpr const char* kWords[] = {
      "position along its x axis (which points right)",   "position along its y axis (which points down)",
      "position along its z axis (which points into it)", "rotation about its x axis (which points right)",
      "rotation about its y axis (which points down)",    "rotation about its z axis (which points into it)"};
  for (int i = 0; i < 6; ++i) {
    Vector6d variances;
    variances << Vector6d::Constant(1e-8);
    variances[i] = i < 3 ? 0.02 * 0.02 : 0.03 * 0.03;
    const WeakDirection weak = TwoTags(variances).of_second();
    EXPECT_EQ(weak.direction, kWords[i]);
    EXPECT_TRUE(weak.is_weak);
    EXPECT_NEAR(weak.sigma, i < 3 ? 0.02 : 0.03, 1e-9);
    EXPECT_NEAR(weak.weakness, i < 3 ? 0.02 / 0.016 : 0.03 / 0.02, 1e-6);
    EXPECT_NEAR(std::abs(weak.axis[i % 3]), 1.0, 1e-9);
    EXPECT_THAT(weak.words, HasSubstr("is barely observed"));
  }
}

TEST(WeakDirections, LieBetweenAxesAndAreAnyInAPlane) {
  Vector6d variances;
  variances << Vector6d::Constant(1e-8);
  variances[3] = variances[4] = 0.03 * 0.03;
  EXPECT_EQ(TwoTags(variances).of_second().direction, "rotation about any axis in its plane");

  TwoTags between(Vector6d::Constant(1e-8));
  const Eigen::Vector3d axis = Eigen::Vector3d(1.0, std::sqrt(3.0), 0.0).normalized();
  between.joint.by_noise.block<3, 3>(9, 9) += 0.03 * 0.03 * axis * axis.transpose();
  EXPECT_EQ(between.of_second().direction,
            "rotation about the axis in its plane that is 60 degrees from right towards down");
}

/// errors_of_corners: that tags keep; else those of whitened edges.
void expect_update_as_by_all_equations(bool errors_of_corners) {
  SyntheticWorld world = wall_of_five();
  look_at_the_four(world);
  for (int i = 0; i < 4; ++i) look(world, {1.0 + 0.1 * i, -3.0, 0.3}, {1.2, 0.0, 0.2});
  const Pose T_world_camera = looking_along({1.6, -1.8, 0.5}, Eigen::Vector3d(-0.3, 1.8, -0.3));
  constexpr int kPictures = 3;
  SyntheticWorld more = world;
  for (int i = 0; i < kPictures; ++i) more.T_world_rig.push_back(T_world_camera);

  const ErrorScale scale{.noise_variance = 1.4, .bias_variance = 0.1, .views_per_independent_view = 1.0};
  const auto joint_of = [&](const SyntheticWorld& seen) {
    UnusedDetections unused;
    const Observations observations =
        collect_observations(test::exact_detections(seen), seen.rig, seen.sizes(), {}, unused);
    MapState state;
    for (const MapTag& tag : seen.map.tags) state.T_map_tag.push_back(tag.T_map_tag);
    state.T_map_rig = seen.T_world_rig;
    state.cameras = observations.cameras;
    std::vector<std::size_t> all(observations.views.size());
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
    const std::vector<int> tags = {0, 1, 2, 3, 4};
    std::vector<LinearView> views = corner_views(observations, all, state);
    for (std::size_t i = 0; errors_of_corners && i < views.size(); ++i)
      views[i].by_error = (views[i].by_error * observations.views[i].whitening).eval();
    JointCovariance joint =
        joint_tag_covariance(*PoseInformation::of(views, tags, 0), tags, observations.tags, scale);
    joint.are_errors_of_corners = errors_of_corners;
    return joint;
  };
  const JointCovariance before = joint_of(world), expected = joint_of(more);
  const PictureEquations picture =
      picture_equations(PictureScene(world.map, before, {}, world.rig.cameras[0]), T_world_camera);
  ASSERT_EQ(picture.tags.size(), 5u) << "the same tags as in the pictures that were added";
  const JointUpdate update(before, picture, kPictures);
  const JointCovariance after = update.updated();
  EXPECT_LT((after.by_noise - expected.by_noise).norm(), 1e-6 * expected.by_noise.norm());
  EXPECT_LT((after.by_errors - expected.by_errors).norm(), 1e-6 * expected.by_errors.norm());
  EXPECT_GT((before.by_noise - expected.by_noise).norm(), 0.1 * expected.by_noise.norm());
  for (Eigen::Index tag = 0; tag < 5; ++tag)
    EXPECT_LE((update.covariance_of(tag) - after.block(6 * tag, 6 * tag)).norm(),
              1e-9 * after.block(6 * tag, 6 * tag).norm());
}

TEST(JointUpdate, IsWhatAllEquationsWithThePictureSay) {
  expect_update_as_by_all_equations(false);
}

TEST(JointUpdate, KeepsErrorsOfCornersApartFromThoseOfEdges) {
  expect_update_as_by_all_equations(true);
}

TEST(ViewAdvice, LowersTheCovarianceAsItSaysWhenThePicturesAreTaken) {
  SyntheticWorld world = wall_of_five();
  look_at_the_four(world);
  for (int i = 0; i < 6; ++i) look(world, {2.4 + 0.05 * i, -4.5, 0.2 + 0.02 * i}, {1.4, 0.0, 0.2});
  const CalibrationOptions options{.held_tag = tag36h11(0)};
  const CalibrationResult before = calibrate_noisy(world, 5, options);
  const MapAssessment assessment = assess(before);
  ASSERT_FALSE(assessment.advice.empty());
  const ViewAdvice& advice = assessment.advice[0];
  EXPECT_EQ(advice.tag, tag36h11(4)) << advice.words;
  EXPECT_LT(advice.sigma_after_rad, 0.5 * advice.sigma_before_rad);
  EXPECT_THAT(advice.words, HasSubstr("5 pictures that show"));

  const Pose T_world_map = world.map.tags[0].T_map_tag;
  for (int i = 0; i < advice.pictures; ++i)
    world.T_world_rig.push_back(T_world_map * advice.T_map_camera *
                                Pose::exp(Vector6d::Constant(0.004 * (i - 2))));  // a hand is not that steady
  const CalibrationResult after = calibrate_noisy(world, 5, options);
  const Matrix6d covariance = *after.map.find(tag36h11(4))->covariance;
  const double sigma_m = std::sqrt(covariance.topLeftCorner<3, 3>().trace());
  const double sigma_rad = std::sqrt(covariance.bottomRightCorner<3, 3>().trace());
  // What the noise is measured to be differs from run to run by some percent.
  EXPECT_NEAR(sigma_m / advice.sigma_after_m, 1.0, 0.2);
  EXPECT_NEAR(sigma_rad / advice.sigma_after_rad, 1.0, 0.2);
}

TEST(ViewAdvice, IsNotGivenWhereAllIsKnownWell) {
  SyntheticWorld world = wall_of_five();
  for (int i = 0; i < 120; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / 40.0;
    look(world, {0.5 + 0.8 * std::cos(angle), -0.9 - 0.002 * i, 0.2 + 0.7 * std::sin(angle)},
         {0.5, 0.0, 0.2});
  }
  std::vector<FrameDetections> frames = test::exact_detections(world);
  RandomStream random(8);
  test::add_edge_noise(frames, 0.02, -0.45, random);
  const CalibrationResult result =
      test::calibrate(world, frames, {.corner_sigma_px = 0.02, .corner_bias_px = 0.0});
  const MapAssessment assessment = assess(result);
  EXPECT_TRUE(assessment.advice.empty()) << assessment.advice[0].words;
  for (const WeakDirection& one : assessment.directions) EXPECT_FALSE(one.is_weak) << one.words;
}

TEST(JoinAdvice, NamesTheTagsThatWereSeenClosestAfterEachOther) {
  SyntheticWorld world = wall_of_five();
  look_at_the_four(world);
  for (int i = 0; i < 3; ++i)  // a part of its own, 3 m farther on, and one more that is alone
    test::add_tag(world, 0.16, looking_along({6.0 + 0.4 * i, 0.0, 0.2}, {0.0, 1.0, 0.0}));
  test::add_tag(world, 0.16, looking_along({11.0, 0.0, 0.2}, {0.0, 1.0, 0.0}));
  for (int i = 0; i < 12; ++i) look(world, {5.4 + 0.18 * i, -1.2, 0.2 + 0.35 * (i % 3 - 1)}, {6.4, 0.0, 0.2});
  for (int i = 0; i < 4; ++i) look(world, {11.0 + 0.1 * i, -1.0, 0.2}, {11.0, 0.0, 0.2});
  const std::vector<FrameDetections> frames = test::exact_detections(world);
  const CalibrationResult result = test::calibrate(world, frames);
  ASSERT_EQ(result.other_parts.size(), 1u) << testing::PrintToString(result.warnings);
  ASSERT_EQ(result.evidence_of_other_parts.size(), 1u);
  EXPECT_EQ(result.evidence_of_other_parts[0].rejected.size(), result.other_parts[0].tags.size());
  const auto advice = advise_joining(result, frames);
  ASSERT_EQ(advice.size(), 2u);
  EXPECT_EQ(advice[0].others.size(), 3u);
  EXPECT_LT(advice[0].of_map.id, 4);
  EXPECT_GE(advice[0].of_other.id, 5);
  double least_s = 1e9;  // between any frame that shows the one part and any that shows the other
  for (const FrameDetections& one : frames) {
    for (const FrameDetections& other : frames) {
      const auto shows = [](const FrameDetections& frame, int from, int to) {
        return std::ranges::any_of(frame.detections, [&](const Detection& seen) {
          return seen.tag.id >= from && seen.tag.id <= to;
        });
      };
      if (shows(one, 0, 3) && shows(other, 5, 7))
        least_s = std::min(least_s, std::abs(seconds_between(one.timestamp, other.timestamp)));
    }
  }
  EXPECT_DOUBLE_EQ(advice[0].apart_s.value(), least_s);
  EXPECT_EQ(advice[1].of_other, tag36h11(8));
  EXPECT_THAT(advice[1].words, HasSubstr("that joins tag36h11/8 to the map"));

  // A pause between the one part and the other: the camera may have been carried anywhere.
  std::vector<FrameDetections> apart = frames;
  const Timestamp first = std::ranges::min(apart, {}, &FrameDetections::timestamp).timestamp;
  for (FrameDetections& frame : apart) {
    const bool is_of_map =
        std::ranges::any_of(frame.detections, [](const Detection& seen) { return seen.tag.id < 5; });
    if (!is_of_map) frame.timestamp.ns += 3'600'000'000'000 + first.ns;
  }
  for (const JoinAdvice& one : advise_joining(result, apart)) {
    EXPECT_FALSE(one.apart_s);
    EXPECT_THAT(one.words, AllOf(HasSubstr("near each other"), Not(HasSubstr("after each other"))));
    EXPECT_LT(one.of_map.id, 4);
    EXPECT_GE(one.of_other.id, 5);
  }
}

}  // namespace
}  // namespace apriltrack
