#include "rivals.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <vector>

#include "plain_world.h"

namespace apriltrack {
namespace {

/// A tag, square to the camera and 2 m before it: 1 cm aside is 1 px aside. Explanations of it are as sure as
/// told, and know of no tag, so that no shared errors widen them.
class WhatIsLeftOpen : public ::testing::Test {
 protected:
  static constexpr double kSigma_m = 0.01, kVelocitySigma_m_per_s = 0.1;

  WhatIsLeftOpen() : world_(test::plain_camera(), test::tags_at_origin({5}), TrackMode::kJoint, 320, 240) {}

  static Explanation at(double x_m, double score, double velocity_m_per_s = 0.0) {
    Explanation explanation;
    explanation.fit.state.pose = Pose(Eigen::Quaterniond::Identity(), {x_m, 0.0, 2.0});
    explanation.fit.state.velocity[0] = velocity_m_per_s;
    explanation.fit.information.diagonal() << Vector6d::Constant(std::pow(kSigma_m, -2)),
        Vector6d::Constant(std::pow(kVelocitySigma_m_per_s, -2));
    explanation.score = score;
    return explanation;
  }
  static Explanation beyond_prior(Explanation explanation) {
    explanation.prior_cost = 100.0;
    return explanation;
  }
  std::vector<MotionHypothesis> left_open(const std::vector<Explanation>& found) const {
    return motions_left_open(world_, belief_of(world_, found.front()), found);
  }
  std::optional<SecondPose> second(const std::vector<Explanation>& found) const {
    return second_pose(belief_of(world_, found.front()), found);
  }
  /// The best sees the tag.
  bool has_rival_among(std::vector<Explanation> found) const {
    found.front().fit.tags = {{.tag_index = 0, .correlation = 0.99}};
    return has_rival(world_, found);
  }

  PhotometricWorld world_;
};

TEST_F(WhatIsLeftOpen, BeliefIsTheFitsWithWhatTheBendLeavesOpen) {
  Explanation best = at(0.1, 0.0, 3.0);
  best.fit.state.acceleration[0] = 7.0;
  best.bend_covariance(0, 0) = 0.5;
  const MotionBelief belief = belief_of(world_, best);
  EXPECT_EQ(belief.mean.pose.translation().x(), 0.1);
  EXPECT_EQ(belief.mean.velocity[0], 3.0);
  EXPECT_TRUE(belief.mean.acceleration.isZero());  // of the exposure alone, not of what comes
  EXPECT_NEAR(belief.covariance(0, 0), 0.5 + kSigma_m * kSigma_m, 1e-9);
  EXPECT_NEAR(belief.covariance(1, 1), kSigma_m * kSigma_m, 1e-9);
  EXPECT_NEAR(belief.covariance(6, 6), kVelocitySigma_m_per_s * kVelocitySigma_m_per_s, 1e-9);
}

TEST_F(WhatIsLeftOpen, AnotherPoseIsFiveStandardDeviationsOff) {
  const MotionBelief belief = belief_of(world_, at(0.0, 0.0));
  EXPECT_FALSE(is_another(belief, at(4.9 * kSigma_m, 0.0).fit.state.pose));
  EXPECT_TRUE(is_another(belief, at(5.1 * kSigma_m, 0.0).fit.state.pose));
}

TEST_F(WhatIsLeftOpen, SecondPoseIsTheLikeliestThatIsAnother) {
  EXPECT_FALSE(second({at(0.0, 50.0)}));
  EXPECT_FALSE(second({at(0.0, 50.0), at(0.04, 49.0)}));      // the same, as far as is known
  EXPECT_FALSE(second({at(0.0, 50.0), at(0.0, 49.0, 5.0)}));  // another motion there
  const auto found = second({at(0.0, 50.0), at(0.04, 49.0), at(0.3, 40.0), at(0.6, 38.0)});
  ASSERT_TRUE(found);
  EXPECT_EQ(found->pose.translation().x(), 0.3);
  EXPECT_NEAR(found->log_odds, -0.25 * 10.0, 1e-12);
}

TEST_F(WhatIsLeftOpen, SecondPoseIsChosenByScoreWhateverThePriorRulesOut) {
  const auto found = second({at(0.0, 50.0), at(0.3, 40.0), beyond_prior(at(0.6, 45.0))});
  ASSERT_TRUE(found);
  EXPECT_EQ(found->pose.translation().x(), 0.6);
  // What scores better than the best is no likelier than it.
  EXPECT_EQ(second({at(0.0, 50.0), beyond_prior(at(0.6, 90.0))})->log_odds, 0.0);
}

TEST_F(WhatIsLeftOpen, AnotherMotionIsCarriedOnWithinFortyNats) {
  EXPECT_EQ(left_open({at(0.0, 50.0)}).size(), 1U);
  EXPECT_EQ(left_open({at(0.0, 50.0), at(0.0, 49.0, 0.45)}).size(), 1U);  // 4.5 standard deviations
  EXPECT_EQ(left_open({at(0.0, 50.0), at(0.0, 9.9, 2.0)}).size(), 1U);
  const std::vector<MotionHypothesis> motions = left_open({at(0.0, 50.0, 1.0), at(0.0, 10.1, -1.0)});
  ASSERT_EQ(motions.size(), 2U);
  EXPECT_EQ(motions[0].belief.mean.velocity[0], 1.0);
  EXPECT_EQ(motions[0].log_odds, 0.0);
  EXPECT_EQ(motions[1].belief.mean.velocity[0], -1.0);
  EXPECT_NEAR(motions[1].log_odds, -0.25 * 39.9, 1e-12);
}

TEST_F(WhatIsLeftOpen, OfOtherMotionsTheLikeliestIsCarriedOn) {
  const std::vector<MotionHypothesis> motions =
      left_open({at(0.0, 50.0, 1.0), at(0.3, 30.0), at(0.0, 20.0, -1.0), beyond_prior(at(0.6, 40.0))});
  ASSERT_EQ(motions.size(), 2U);
  EXPECT_EQ(motions[1].belief.mean.pose.translation().x(), 0.6);
}

TEST_F(WhatIsLeftOpen, RivalPutsATagTenPixelsAsideAtAboutTheSameScore) {
  EXPECT_FALSE(has_rival_among({at(0.0, 50.0)}));
  EXPECT_FALSE(has_rival_among({at(0.0, 50.0), at(0.099, 49.0)}));
  EXPECT_TRUE(has_rival_among({at(0.0, 50.0), at(0.101, 49.0)}));
  EXPECT_TRUE(has_rival_among({at(0.0, 50.0), at(0.5, 43.1)}));
  EXPECT_FALSE(has_rival_among({at(0.0, 50.0), at(0.5, 42.9)}));
  EXPECT_TRUE(has_rival_among({at(0.0, 50.0), at(0.05, 49.0), at(0.5, 48.0)}));
}

TEST_F(WhatIsLeftOpen, RivalMayPutTheTagBehindTheCamera) {
  Explanation behind = at(0.0, 49.0);
  behind.fit.state.pose = Pose(Eigen::Quaterniond::Identity(), {0.0, 0.0, -2.0});
  EXPECT_TRUE(has_rival_among({at(0.0, 50.0), behind}));
}

}  // namespace
}  // namespace apriltrack
