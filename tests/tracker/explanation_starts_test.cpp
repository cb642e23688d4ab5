#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>
#include <vector>

#include "motion_start.h"
#include "overruled_motion.h"
#include "path_variation.h"
#include "tag_picture.h"

namespace apriltrack {
namespace {

using test::TagMotion;
using test::TagPicture;

/// A tag that goes some way during the exposure, and what a detector would say of it.
class StartsBeforeATag : public ::testing::Test {
 protected:
  explicit StartsBeforeATag(double heading_rad = 0.9, double path_px = 16.0)
      : picture_(moving(heading_rad, path_px)), world_(picture_.world()) {
    frame_.photometric = picture_.frame();
    frame_.detections = {detection()};
    frame_.read = observe_mapped_tags(picture_.map, world_.index, picture_.camera.model, frame_.detections,
                                      options_.corner_sigma_px);
    frame_.observations = frame_.read;
    candidate_.T_camera_map = picture_.truth.pose;
    for (const TagObservation& seen : frame_.observations) candidate_.inliers.push_back(&seen);
  }

  static TagMotion moving(double heading_rad, double path_px) {
    const double speed_m_per_s =
        path_px * TagPicture::kDepth_m / TagPicture::kFocal_px / TagPicture::kExposure_s;
    TagMotion moves;
    moves.velocity_m_per_s << speed_m_per_s * std::cos(heading_rad), speed_m_per_s * std::sin(heading_rad),
        0.0;
    moves.yaw_rate_rad_per_s = 0.0;
    return moves;
  }
  static BlurTrackerOptions of_bodies() {
    BlurTrackerOptions options;
    options.mode = TrackMode::kJoint;
    return options;
  }
  Detection detection() const {
    Detection result;
    result.tag = picture_.map.tags[0].key;
    const auto corners = tag_corners(TagPicture::kSize_m);
    for (std::size_t i = 0; i < kNumCorners; ++i)
      result.corners_px[i] = *picture_.camera.model.project(picture_.truth.pose * corners[i]);
    return result;
  }
  /// At rest, where the corners are.
  MotionStart cold_start() const {
    const MotionBelief belief = *cold_belief(world_, candidate_);
    return {belief.mean, {belief, 0.0}, true};
  }
  /// Of the tag in the image, during the exposure.
  Eigen::Vector2d path_px(const MotionState& state) const {
    const Pose from = pose_after(state, -0.5 * TagPicture::kExposure_s),
               to = pose_after(state, 0.5 * TagPicture::kExposure_s);
    return *picture_.camera.model.project(to.translation()) -
           *picture_.camera.model.project(from.translation());
  }

  TagPicture picture_;
  mutable PhotometricWorld world_;
  BlurTrackerOptions options_ = of_bodies();
  StartFit start_fit_{world_, options_};
  BlurFrame frame_;
  PoseCandidate candidate_;
};

/// The way, in sixteenths of half a circle, and its length in pixels.
class ColdStart : public StartsBeforeATag, public ::testing::WithParamInterface<std::tuple<int, double>> {
 protected:
  ColdStart()
      : StartsBeforeATag(std::numbers::pi * std::get<0>(GetParam()) / 16.0, std::get<1>(GetParam())) {}
};
INSTANTIATE_TEST_SUITE_P(Ways, ColdStart,
                         ::testing::Combine(::testing::Range(0, 16), ::testing::Values(5.0, 16.0, 28.0)));

TEST_P(ColdStart, FindsThePathWhateverItsDirection) {
  std::vector<Explanation> found = {start_fit_.explained(frame_, cold_start(), {})};
  const Eigen::Vector2d truth_px = path_px(picture_.truth);
  vary_velocity(start_fit_, frame_, found);
  const Eigen::Vector2d found_px = path_px(found.front().fit.state);
  // Its reverse looks the same. What is known of no motion holds a fast one back a little.
  EXPECT_LT(std::min((found_px - truth_px).norm(), (found_px + truth_px).norm()),
            truth_px.norm() < 20.0 ? 1.0 : 0.1 * truth_px.norm())
      << found_px.transpose() << " for " << truth_px.transpose();
}

TEST(LoneExplanation, IsNotTrustedWhereItSurprisesUnread) {
  Explanation one;
  one.fit.tags = {{.tag_index = 0, .num_pixels = 700, .area_px = 700.0, .correlation = 0.99}};
  one.prior_cost = 24.6;
  EXPECT_TRUE(surprises_alone(one));
  one.votes.agreeing = {0};
  EXPECT_FALSE(surprises_alone(one));
  one.votes = {};
  one.is_cold = true;
  EXPECT_FALSE(surprises_alone(one));
  one.is_cold = false;
  one.fit.tags.push_back(one.fit.tags.front());
  EXPECT_FALSE(surprises_alone(one));
  one.fit.tags.pop_back();
  one.prior_cost = 24.4;
  EXPECT_FALSE(surprises_alone(one));
}

TEST(LoneExplanation, RestsOnAPartWhereAnEighthIsUnexplained) {
  Explanation one;
  one.fit.tags = {{.tag_index = 0, .num_pixels = 700, .area_px = 700.0, .correlation = 0.93}};
  EXPECT_TRUE(rests_on_part_of_a_tag(one));
  one.fit.tags.front().correlation = 0.95;
  EXPECT_FALSE(rests_on_part_of_a_tag(one));
  one.fit.tags.front().correlation = 0.93;
  one.fit.tags.push_back(one.fit.tags.front());  // two tell of each other's tilt
  EXPECT_FALSE(rests_on_part_of_a_tag(one));
}

class OverruledMotion : public StartsBeforeATag {
 protected:
  /// Half a tag away, as a motion expects it that was never there.
  MotionHypothesis mistaken() const {
    MotionBelief belief{picture_.truth, 1e-6 * Matrix12d::Identity()};
    belief.mean.pose =
        Pose(belief.mean.pose.rotation(), belief.mean.pose.translation() + Eigen::Vector3d(0.07, 0.0, 0.0));
    return {belief, 0.0};
  }
  Explanation explained(const MotionState& state, const MotionHypothesis& prior) const {
    return start_fit_.explained(frame_, {state, prior, false}, {.coarsest_level = 0});
  }
  /// What the mistaken motion makes of the frame, and the truth, which it rules out.
  std::vector<Explanation> found() const {
    Explanation wrong = explained(mistaken().belief.mean, mistaken());
    Explanation right = explained(picture_.truth, {{picture_.truth, 1e-6 * Matrix12d::Identity()}, 0.0});
    right.prior = mistaken();
    right.prior_cost = prior_cost(right.prior.belief, right.fit.state);
    right.score -= kMaxScoredPriorCost;
    return {wrong, right};
  }
};

TEST_F(OverruledMotion, IsSeenWhereWhatItRulesOutIsFarBetter) {
  std::vector<Explanation> both = found();
  ASSERT_TRUE(both[1].is_beyond_prior());
  ASSERT_FALSE(both[0].is_beyond_prior());
  EXPECT_TRUE(is_overruled(both));
  both[1].score = both[0].score + 19.0;
  EXPECT_FALSE(is_overruled(both));
  EXPECT_FALSE(is_overruled({both[0]}));
}

TEST_F(OverruledMotion, GivesWayToWhatDetectionsHold) {
  std::vector<Explanation> both = found();
  start_over_where_overruled(start_fit_, frame_, both);
  EXPECT_TRUE(both.front().is_cold);
  EXPECT_FALSE(is_overruled(both));
  EXPECT_LT((both.front().fit.state.pose.translation() - picture_.truth.pose.translation()).norm(), 0.002);
}

TEST_F(OverruledMotion, StaysInDoubtWithoutDetections) {
  std::vector<Explanation> both = found();
  for (Explanation& one : both) one.votes = {};
  start_over_where_overruled(start_fit_, frame_, both);
  EXPECT_EQ(both.size(), 2U);
  EXPECT_TRUE(is_overruled(both));
}

}  // namespace
}  // namespace apriltrack
