#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <vector>

#include "apriltrack/tracker/blur_tracker.h"
#include "blur_corners.h"
#include "blur_film.h"
#include "motion_memory.h"
#include "plain_world.h"

namespace apriltrack::test {
namespace {

TEST(BlurTracker, FollowsWhatTurnsAboutWhileItIsBlurred) {
  // A path and its reverse blur alike, and constant velocity expects the wrong one at each turn: only the
  // frame after it can tell.
  constexpr std::size_t kNumRead = 1;
  const BlurFilm& film = swung_camera();
  BlurTrackerOptions options;
  options.num_particles = 16;  // no search finds by chance what was not expected
  BlurTracker tracker(film.scene.camera, film.scene.map, options);
  double most_blur_px = 0.0;
  for (std::size_t i = 0; i < film.size(); ++i) {
    const TrackResult result =
        tracker.track(film.frames[i].frame(), i < kNumRead ? film.detections[i] : std::vector<Detection>());
    ASSERT_TRUE(result.pose) << "frame " << i;
    EXPECT_EQ(result.status, i < kNumRead ? TrackStatus::kDetected : TrackStatus::kTracked) << "frame " << i;
    // The second frame has but a guess of the velocity to start from.
    EXPECT_LT(film.corner_error_px(i, *result.pose), i <= kNumRead ? 3.0 : 1.5) << "frame " << i;
    most_blur_px = std::max(most_blur_px, film.blur_px[i]);
  }
  EXPECT_GT(most_blur_px, 25.0);
}

TEST(MotionMemory, KeepsSeveralMotionsForAsLongAsAllowed) {
  const MotionNoise noise;
  MotionMemory memory(noise, 0.5);
  EXPECT_TRUE(memory.predict({0}).empty());
  MotionBelief there, back;
  there.mean.velocity << 1.0, 0.0, 0.0, 0.0, 0.0, 2.0;
  back.mean.velocity = -there.mean.velocity;
  memory.remember({1'000'000'000}, {{there, 0.0}, {back, -3.0}});
  const std::vector<MotionHypothesis> expected = memory.predict({1'100'000'000});
  ASSERT_EQ(expected.size(), 2U);
  EXPECT_NEAR(memory.age_s({1'100'000'000}).value_or(0.0), 0.1, 1e-12);
  EXPECT_NEAR(expected[0].belief.mean.pose.translation().x(), 0.1, 1e-12);
  EXPECT_NEAR(expected[1].belief.mean.pose.translation().x(), -0.1, 1e-12);
  EXPECT_EQ(expected[1].log_odds, -3.0);
  EXPECT_NEAR(expected[1].belief.covariance(6, 6), 0.1 * noise.linear_m2_per_s3, 1e-12);
  EXPECT_EQ(memory.predict({1'500'000'000}).size(), 2U);
  for (const std::int64_t time_ns : {1'500'000'001, 1'000'000'000, 999'999'999}) {
    EXPECT_TRUE(memory.predict({time_ns}).empty()) << time_ns;
    EXPECT_FALSE(memory.age_s({time_ns})) << time_ns;
  }
}

constexpr std::int64_t kFrame_ns = 40'000'000;
constexpr double kFrame_s = 0.04;

/// Turns about y at rate_per_s, or the other way.
std::vector<MotionHypothesis> there_and_back(double rate_per_s, double log_odds_back) {
  MotionBelief there, back;
  there.mean.velocity[4] = rate_per_s;
  back.mean.velocity[4] = -rate_per_s;
  there.covariance.diagonal() << Vector6d::Constant(1e-6), Vector6d::Constant(0.01);
  back.covariance = there.covariance;
  return {{there, 0.0}, {back, log_odds_back}};
}

SeenTurn turn_about_y(double angle_rad) {
  return {{Eigen::Quaterniond(Eigen::AngleAxisd(angle_rad, Eigen::Vector3d::UnitY())), 0.02},
          {0.0, 0.0, 2.0}};
}

TEST(MotionMemory, ExpectsTheMotionThatTheTurnAgreesWith) {
  MotionMemory memory({}, 0.5);
  memory.remember({0}, there_and_back(1.5, -2.0));
  const std::vector<MotionHypothesis> alone = memory.predict({kFrame_ns});
  EXPECT_GT(alone[0].belief.mean.velocity[4], 0.0);
  EXPECT_FALSE(alone[0].unaided);
  EXPECT_EQ(alone[0].expected_velocity(), alone[0].belief.mean.velocity);

  const std::vector<MotionHypothesis> turned =
      memory.predict({kFrame_ns}, 0.0, turn_about_y(-1.5 * kFrame_s));
  ASSERT_EQ(turned.size(), 2U);
  EXPECT_NEAR(turned[0].belief.mean.velocity[4], -1.5, 1e-6);
  EXPECT_EQ(turned[0].log_odds, 0.0);
  // The one is as expected, the other off by twice the angle; of the angle's variance, in closed form: what
  // was known of the rate, its noise since, and what the turn leaves open. Nothing is known of how the camera
  // goes but that it hardly does: less than 0.2 m/s, or 4 mm at 2 m, besides noise.
  const MotionNoise noise;
  const double variance =
      0.01 * kFrame_s * kFrame_s + noise.angular_rad2_per_s3 * std::pow(kFrame_s, 3) / 3.0 + 0.02 * 0.02 +
      (0.01 * kFrame_s * kFrame_s + noise.linear_m2_per_s3 * std::pow(kFrame_s, 3) / 3.0) / 4.0;
  const double off = 2.0 * 1.5 * kFrame_s;
  EXPECT_NEAR(turned[1].log_odds, -0.5 * off * off / variance + 2.0, 0.02);
}

TEST(MotionMemory, KeepsWhatEvidenceAloneLeadsTo) {
  MotionMemory memory({}, 0.5);
  MotionBelief alone = there_and_back(1.0, 0.0)[1].belief;
  memory.remember({0}, {{alone}});
  double rate_before = alone.mean.velocity[4];
  for (int frame = 1; frame <= 3; ++frame) {
    alone = predict(alone, MotionNoise(), kFrame_s);
    const std::vector<MotionHypothesis> expected =
        memory.predict({frame * kFrame_ns}, 0.0, turn_about_y(-1.4 * kFrame_s));
    ASSERT_TRUE(expected[0].unaided) << frame;
    EXPECT_EQ(expected[0].unaided->mean.velocity, alone.mean.velocity) << frame;
    EXPECT_LT((expected[0].unaided->covariance - alone.covariance).norm(), 1e-12) << frame;
    EXPECT_EQ(&expected[0].by_evidence(), &*expected[0].unaided);
    EXPECT_LT(expected[0].belief.mean.velocity[4], -1.05) << frame;  // the turn was faster
    EXPECT_NEAR(expected[0].expected_velocity()[4], rate_before, 1e-12) << frame;
    rate_before = expected[0].belief.mean.velocity[4];
    memory.step({frame * kFrame_ns}, expected);
  }
  // A frame whose turn was not seen goes on from there.
  const std::vector<MotionHypothesis> expected = memory.predict({4 * kFrame_ns});
  ASSERT_TRUE(expected[0].unaided);
  EXPECT_LT((expected[0].unaided->covariance - predict(alone, MotionNoise(), kFrame_s).covariance).norm(),
            1e-12);
  EXPECT_EQ(expected[0].expected_velocity(), expected[0].belief.mean.velocity);
}

TEST(MotionMemory, GoesOnFromTheLastStep) {
  MotionMemory memory({}, 0.5);
  memory.remember({0}, there_and_back(1.0, -2.0));
  // The camera stands still from now on, and its turns say so.
  for (int frame = 1; frame <= 5; ++frame)
    memory.step({frame * kFrame_ns}, memory.predict({frame * kFrame_ns}, 0.0, turn_about_y(0.0)));
  EXPECT_FALSE(memory.at({4 * kFrame_ns}));
  const MotionState* last = memory.at({5 * kFrame_ns});
  ASSERT_TRUE(last);
  const double angle = 2.0 * std::asin(last->pose.rotation().y());
  EXPECT_LT(std::abs(last->velocity[4]), 0.2);
  EXPECT_LT(std::abs(angle), 0.03);  // 0.2 without
  EXPECT_NEAR(2.0 * std::asin(memory.predict({6 * kFrame_ns})[0].belief.mean.pose.rotation().y()),
              angle + kFrame_s * last->velocity[4], 1e-9);
}

TEST(MotionMemory, GrowsOldFromTheEvidenceOn) {
  MotionMemory memory({}, 0.1);
  memory.remember({0}, there_and_back(1.0, -2.0));
  for (int frame = 1; frame <= 2; ++frame) {
    const Timestamp time{frame * kFrame_ns};
    EXPECT_NEAR(memory.age_s(time).value_or(0.0), frame * kFrame_s, 1e-12);
    EXPECT_NEAR(memory.step_s(time).value_or(0.0), kFrame_s, 1e-12);
    memory.step(time, memory.predict(time, 0.0, turn_about_y(0.04)));
  }
  const Timestamp late{3 * kFrame_ns};
  EXPECT_FALSE(memory.age_s(late));
  EXPECT_FALSE(memory.step_s(late));
  EXPECT_TRUE(memory.predict(late, 0.0, turn_about_y(0.04)).empty());
  EXPECT_TRUE(memory.at({2 * kFrame_ns}));
}

/// Two tags of 0.2 m, 0.5 m apart, square before a camera, 2 m away.
class TagsReadAsOthers : public ::testing::Test {
 protected:
  TagsReadAsOthers() : world_(plain_camera(), map(), TrackMode::kJoint, 320, 240) {
    state_.pose = {Eigen::Quaterniond::Identity(), {0.0, 0.0, 2.0}};
  }

  static TagMap map() {
    TagMap map = tags_at_origin({0, 1});
    map.tags[1].T_map_tag = {Eigen::Quaterniond::Identity(), {0.5, 0.0, 0.0}};
    return map;
  }
  /// Usually 20 px wide, as the tags are.
  static Detection detection(int id, double x_px, double y_px, std::optional<int> corrected_bits = 0,
                             double half_px = 10.0) {
    Detection result;
    result.tag = {"tag36h11", id};
    result.hamming = corrected_bits;
    const Eigen::Vector2d middle(x_px, y_px), right(half_px, 0.0), down(0.0, half_px);
    result.corners_px = {middle - right + down, middle + right + down, middle + right - down,
                         middle - right - down};
    return result;
  }
  std::vector<double> correlations_after(const std::vector<Detection>& detections,
                                         const TagVotes& votes = {}) {
    std::vector<TagEvidence> tags(2);
    for (int k = 0; k < 2; ++k) {
      tags[static_cast<std::size_t>(k)].tag_index = k;
      tags[static_cast<std::size_t>(k)].correlation = 0.9;
    }
    discredit_tags_read_as_others(world_, detections, state_, votes, tags);
    return {tags[0].correlation, tags[1].correlation};
  }

  PhotometricWorld world_;
  MotionState state_;
};

TEST_F(TagsReadAsOthers, AreNoEvidence) {
  using Correlations = std::vector<double>;
  // Tag 0 is at (160, 120), tag 1 at (210, 120).
  EXPECT_EQ(correlations_after({}), Correlations({0.9, 0.9}));
  EXPECT_EQ(correlations_after({detection(0, 160, 120), detection(1, 210, 120)}), Correlations({0.9, 0.9}));
  EXPECT_EQ(correlations_after({detection(7, 160, 120)}), Correlations({0.0, 0.9}));
  EXPECT_EQ(correlations_after({detection(0, 210, 120)}), Correlations({0.9, 0.0}));  // mapped, elsewhere
  EXPECT_EQ(correlations_after({detection(7, 169, 129)}), Correlations({0.0, 0.9}));  // its middle on the tag
  EXPECT_EQ(correlations_after({detection(7, 172, 120)}), Correlations({0.9, 0.9}));
  EXPECT_EQ(correlations_after({detection(7, 160, 120, 1)}), Correlations({0.9, 0.9}));  // may be false
  EXPECT_EQ(correlations_after({detection(7, 160, 120, std::nullopt)}), Correlations({0.0, 0.9}));
  EXPECT_EQ(correlations_after({detection(7, 160, 120, 0, 4.0)}), Correlations({0.9, 0.9}));   // upon the tag
  EXPECT_EQ(correlations_after({detection(7, 160, 120, 0, 25.0)}), Correlations({0.9, 0.9}));  // under it
}

TEST_F(TagsReadAsOthers, AreSparedWhereTheTagOrTheOtherAgrees) {
  using Correlations = std::vector<double>;
  const std::vector<Detection> both = {detection(0, 160, 120), detection(7, 160, 120)};
  EXPECT_EQ(correlations_after(both, {{0}, {}}), Correlations({0.9, 0.9}));
  const std::vector<Detection> other = {detection(1, 160, 120)};
  EXPECT_EQ(correlations_after(other), Correlations({0.0, 0.9}));
  EXPECT_EQ(correlations_after(other, {{1}, {}}), Correlations({0.9, 0.9}));
}

}  // namespace
}  // namespace apriltrack::test
