#include <gtest/gtest.h>

#include <vector>

#include "joint_fixture.h"

namespace apriltrack {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)

Motion across_the_picture() {
  Motion motion = Motion::fixed(facing(0.0, 0.0, 0.7));
  motion.position_m[0].rate_per_s = 1.1;  // 12.6 px during the exposure, of a tag of 91 px
  motion.position_m[1].rate_per_s = 0.6;
  return motion;
}

class FilmedTag : public ::testing::Test {
 protected:
  JointScores evaluate(const std::vector<MotionState>& hypotheses) const {
    JointLikelihood likelihood(camera_320(), one_tag(), TrackMode::kJoint);
    JointScores scores;
    likelihood.evaluate(film_.frame, hypotheses, kSerial, &scores);
    return scores;
  }

  const test::TagFilm film_{camera_320().model, across_the_picture()};
  const MotionState truth_ = film_.truth;
};

TEST_F(FilmedTag, LooksAsThePatternPredicts) {
  const JointScores scores = evaluate({truth_, at_rest(truth_.pose)});
  EXPECT_GT(scores.tag(0, 0).correlation, 0.99);
  EXPECT_LT(scores.tag(1, 0).correlation, 0.9);  // as if it were sharp
}

TEST_F(FilmedTag, IsLikeliestWhereItIsAndMovesAsItDoes) {
  std::vector<MotionState> hypotheses = {truth_};
  for (int axis = 0; axis < 6; ++axis) {
    for (const double sign : {-1.0, 1.0}) {
      Vector6d step = Vector6d::Zero();
      step[axis] = sign * (axis < 2 ? 0.002 : axis == 2 ? 0.02 : axis == 5 ? 0.02 : 0.1);
      MotionState moved = truth_, faster = truth_;
      moved.pose = moved.pose * Pose::exp(step);
      faster.velocity[axis] += sign * (axis < 2 ? 0.25 : axis == 2 ? 3.0 : axis == 5 ? 3.0 : 12.0);
      hypotheses.push_back(moved);
      hypotheses.push_back(faster);
    }
  }
  const JointScores scores = evaluate(hypotheses);
  for (std::size_t i = 1; i < hypotheses.size(); ++i) {
    EXPECT_GT(scores.log_likelihoods[0], scores.log_likelihoods[i] + 1.0)
        << "pose " << hypotheses[i].pose.log().transpose() << ", velocity "
        << hypotheses[i].velocity.transpose();
  }
}

TEST_F(FilmedTag, TellsForwardFromBackwardByNothing) {
  MotionState backward = truth_;
  backward.velocity = -truth_.velocity;
  const JointScores scores = evaluate({truth_, backward});
  EXPECT_NEAR(scores.log_likelihoods[0], scores.log_likelihoods[1], 0.02 * scores.log_likelihoods[0]);
}

TEST_F(FilmedTag, DropsOnlyHypothesesThatAreNegligible) {
  RandomStream random(43);
  std::vector<MotionState> hypotheses = {truth_};
  for (int i = 0; i < 300; ++i) {
    Vector12d step = Vector12d::Zero();
    for (Eigen::Index k = 0; k < 3; ++k) step[k] = 0.02 * random.normal();
    hypotheses.push_back(moved(truth_, step));
  }
  JointLikelihoodOptions options;
  options.negligible_log_ratio = 20.0;
  EXPECT_GT(num_dropped(options, film_.frame, {}, hypotheses), 100);
}

}  // namespace
}  // namespace apriltrack
