#include "pose_report.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "apriltrack/geometry/rotation.h"
#include "plain_world.h"

namespace apriltrack {
namespace {

/// A tag 2 m before the camera, whose place in the map is known to some millimetres and half a degree.
class ReportedPose : public ::testing::TestWithParam<TrackMode> {
 protected:
  static constexpr double kSigma = 0.01;

  ReportedPose() : world_(test::plain_camera(), map(), GetParam(), 320, 240), report_(world_) {}

  static TagMap map() {
    TagMap map = test::tags_at_origin({5});
    map.tags[0].covariance = map_sigma().cwiseAbs2().asDiagonal();
    return map;
  }
  static Vector6d map_sigma() { return (Vector6d() << 0.003, 0.001, 0.006, 0.002, 0.008, 0.004).finished(); }
  static Explanation at(const Pose& T_camera_map, double score, bool is_read = false) {
    Explanation explanation;
    explanation.fit.state.pose = pose_from_camera(T_camera_map, GetParam());
    explanation.fit.state.velocity = Vector6d::Constant(0.2);
    explanation.fit.information = Matrix12d::Identity() / (kSigma * kSigma);
    explanation.fit.tags = {{.tag_index = 0, .correlation = 0.99}};
    explanation.score = score;
    if (is_read) explanation.votes.agreeing = {0};
    return explanation;
  }
  static Pose ahead(double x_m) { return {rotation_exp({0.2, 0.3, 0.0}), {x_m, 0.0, 2.0}}; }
  TrackResult found(const std::vector<Explanation>& found) {
    return report_.found(found, belief_of(world_, found.front()));
  }
  static MotionHypothesis expected_at(const Pose& T_camera_map, double log_odds) {
    MotionBelief belief;
    belief.mean.pose = pose_from_camera(T_camera_map, GetParam());
    belief.mean.velocity = Vector6d::Constant(0.4);
    belief.covariance = kSigma * kSigma * Matrix12d::Identity();
    return {belief, log_odds};
  }
  /// A map that is off by `shift` at the tag, and the camera with it: the change of a pose that shows the
  /// same picture, as a right perturbation.
  static Vector6d off_by_map(const Pose& pose, const Vector6d& shift) {
    const Pose shifted = Pose::exp(shift);
    const Pose other = GetParam() == TrackMode::kEgo ? shifted * pose : pose * shifted.inverse();
    return (pose.inverse() * other).log();
  }
  static Matrix6d covariance_by_map(const Pose& pose) {
    Matrix6d sum = Matrix6d::Zero();
    for (int number = 0; number < 6; ++number) {
      const Vector6d off = off_by_map(pose, map_sigma()[number] * Vector6d::Unit(number));
      sum += off * off.transpose();
    }
    return sum;
  }

  PhotometricWorld world_;
  PoseReport report_;
};
INSTANTIATE_TEST_SUITE_P(Modes, ReportedPose, ::testing::Values(TrackMode::kEgo, TrackMode::kJoint),
                         [](const auto& mode) { return mode.param == TrackMode::kEgo ? "Ego" : "Joint"; });

TEST_P(ReportedPose, IsDetectedWhereATagThatWasReadAgreesElseTracked) {
  EXPECT_EQ(found({at(ahead(0.0), 9.0, true)}).status, TrackStatus::kDetected);
  EXPECT_EQ(found({at(ahead(0.0), 9.0, false)}).status, TrackStatus::kTracked);
  EXPECT_EQ(found({at(ahead(0.0), 9.0, false), at(ahead(0.5), 8.0, true)}).status, TrackStatus::kTracked);
}

TEST_P(ReportedPose, IsThatOfTheBestWithWhatTheMapMayBeOffBy) {
  const Explanation best = at(ahead(0.1), 9.0);
  const TrackResult result = found({best});
  EXPECT_EQ(result.pose->translation(), best.fit.state.pose.translation());
  EXPECT_EQ(*result.velocity, best.fit.state.velocity);
  const Matrix6d by_map = *result.covariance - belief_of(world_, best).covariance.topLeftCorner<6, 6>();
  EXPECT_LT((by_map - covariance_by_map(best.fit.state.pose)).norm(), 1e-9) << by_map;
}

TEST_P(ReportedPose, TellsTheSecondPoseUnlessItIsRuledOut) {
  EXPECT_FALSE(found({at(ahead(0.0), 50.0)}).second_pose);
  const Explanation second = at(ahead(0.5), 42.0);
  const TrackResult result = found({at(ahead(0.0), 50.0), second});
  ASSERT_TRUE(result.second_pose);
  EXPECT_EQ(result.second_pose->translation(), second.fit.state.pose.translation());
  EXPECT_NEAR(result.second_mode_odds, std::exp(-2.0), 1e-12);
  const double least = 4.0 * std::log(1e-3);  // odds of one in a thousand
  EXPECT_TRUE(found({at(ahead(0.0), 50.0), at(ahead(0.5), 50.0 + least + 0.01)}).second_pose);
  EXPECT_FALSE(found({at(ahead(0.0), 50.0), at(ahead(0.5), 50.0 + least - 0.01)}).second_pose);
}

TEST_P(ReportedPose, IsLostWhereNothingIsExpected) {
  const TrackResult result = report_.expected({});
  EXPECT_EQ(result.status, TrackStatus::kLost);
  EXPECT_FALSE(result.pose || result.velocity || result.covariance);
}

TEST_P(ReportedPose, IsPredictedAsTheLikeliestMotionExpectsIt) {
  const TrackResult result = report_.expected({expected_at(ahead(0.2), 0.0), expected_at(ahead(0.9), -1.5)});
  EXPECT_EQ(result.status, TrackStatus::kPredicted);
  EXPECT_EQ(result.pose->translation(), pose_from_camera(ahead(0.2), GetParam()).translation());
  EXPECT_EQ(*result.velocity, Vector6d::Constant(0.4));
  EXPECT_NEAR(result.second_mode_odds, std::exp(-1.5), 1e-12);
  EXPECT_EQ(result.second_pose->translation(), pose_from_camera(ahead(0.9), GetParam()).translation());
  // The same, as far as is known.
  EXPECT_FALSE(report_.expected({expected_at(ahead(0.2), 0.0), expected_at(ahead(0.21), -1.5)}).second_pose);
}

TEST_P(ReportedPose, PredictedIsAsWrongAsTheMapOfThePoseFoundLast) {
  found({at(ahead(0.0), 9.0)});
  const Pose T_camera_map(rotation_exp({-0.4, 0.1, 0.5}), {0.4, 0.2, 1.5});
  const MotionHypothesis next = expected_at(T_camera_map, 0.0);
  const TrackResult result = report_.expected({next});
  const Matrix6d by_map = *result.covariance - next.belief.covariance.topLeftCorner<6, 6>();
  EXPECT_LT((by_map - covariance_by_map(*result.pose)).norm(), 1e-9) << by_map;
}

TEST_P(ReportedPose, IsTheMeanOfFramesAtRestUntilOneShowsNothing) {
  // Every other frame is half a standard deviation aside.
  const auto frame = [&](int i) { return at(ahead(0.5 * kSigma * (i % 2)), 9.0); };
  const auto offset = [&](const TrackResult& result) {
    return camera_from_map(*result.pose, GetParam()).translation().x() / kSigma;
  };
  TrackResult last;
  for (int i = 0; i < 40; ++i) last = found({frame(i)});
  EXPECT_NEAR(offset(last), 0.25, 0.06);
  report_.expected({expected_at(ahead(0.0), 0.0)});
  EXPECT_NEAR(offset(found({frame(0)})), 0.0, 1e-9);
}

}  // namespace
}  // namespace apriltrack
