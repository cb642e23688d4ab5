#include "blur_corners.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "plain_world.h"

namespace apriltrack {
namespace {

constexpr double kFocal_px = 200.0;
constexpr double kDepth_m = 2.0;
constexpr double kExposure_s = 0.01;
constexpr double kSharpSigma_px = 0.1;
/// Of tag 0, square to the view: 20 px.
constexpr double kSize_m = 0.2;

/// Three tags in a plane square to a pinhole camera: their ids are no indices.
TagMap flat_map() {
  TagMap map;
  for (const int id : {5, 3, 4}) {
    MapTag tag;
    tag.key = {"tag36h11", id};
    tag.size_m = kSize_m;
    tag.T_map_tag = {Eigen::Quaterniond::Identity(), {0.3 * (id - 4), 0.0, 0.0}};
    map.tags.push_back(tag);
  }
  return map;
}

/// The corners of a tag of flat_map() in the image, shifted: f x / z, by hand.
TagObservation observation_of(const MapTag& tag, const Eigen::Vector2d& shift_px = {0.0, 0.0}) {
  TagObservation observation;
  observation.tag = &tag;
  observation.corners_map = corners_in_map(tag);
  for (std::size_t i = 0; i < kNumCorners; ++i) {
    observation.corners_px[i] = Eigen::Vector2d(160.0, 120.0) + shift_px +
                                kFocal_px / kDepth_m * observation.corners_map[i].head<2>();
  }
  return observation;
}

/// The tags slide to the right by path_px during the exposure; in both modes the same is seen.
class DetectedTags : public ::testing::TestWithParam<TrackMode> {
 protected:
  DetectedTags() : world_(test::plain_camera(), map_, GetParam(), 320, 240) {}

  MotionState sliding(double path_px) const {
    const double speed_m_per_s = path_px * kDepth_m / kFocal_px / kExposure_s;
    const bool is_ego = GetParam() == TrackMode::kEgo;
    MotionState state;
    state.pose = {Eigen::Quaterniond::Identity(), {0.0, 0.0, is_ego ? -kDepth_m : kDepth_m}};
    state.velocity[0] = is_ego ? -speed_m_per_s : speed_m_per_s;
    return state;
  }
  TagVotes votes(std::vector<TagObservation> observations, double path_px = 0.0) const {
    for (TagObservation& seen : observations) seen.tag_index = static_cast<int>(seen.tag - map_.tags.data());
    return count_votes(world_, observations, sliding(path_px), kExposure_s, kSharpSigma_px);
  }

  TagMap map_ = flat_map();
  PhotometricWorld world_;
};

INSTANTIATE_TEST_SUITE_P(Modes, DetectedTags, ::testing::Values(TrackMode::kEgo, TrackMode::kJoint),
                         [](const auto& mode) { return mode.param == TrackMode::kEgo ? "Ego" : "Joint"; });

using Indices = std::vector<int>;

TEST_P(DetectedTags, AgreeWithinOnePixelAndFourSigmaAndFivePixelsAtMost) {
  for (const double path_px : {0.0, 4.0, 10.0, 15.0, 60.0}) {
    const double sigma_px = std::hypot(0.2, 0.06 * path_px);  // (6) of the blur tracker's page
    const double limit_px = std::min(1.0 + 4.0 * sigma_px, 5.0);
    for (const double angle_rad : {0.0, 0.7, 2.5}) {
      const Eigen::Vector2d direction(std::cos(angle_rad), std::sin(angle_rad));
      const TagVotes near = votes({observation_of(map_.tags[1], (limit_px - 1e-3) * direction)}, path_px);
      EXPECT_EQ(near.agreeing, Indices({1})) << path_px;
      EXPECT_EQ(near.contradicting.size(), 0U) << path_px;
      const TagVotes far = votes({observation_of(map_.tags[1], (limit_px + 1e-3) * direction)}, path_px);
      EXPECT_EQ(far.agreeing, Indices()) << path_px;
      EXPECT_EQ(far.contradicting.size(), 1U) << path_px;
    }
  }
}

TEST_P(DetectedTags, ContradictByOneCorner) {
  for (std::size_t i = 0; i < kNumCorners; ++i) {
    TagObservation observation = observation_of(map_.tags[0]);
    observation.corners_px[i].y() += 1.81;  // 1 px + 4 * 0.2 px
    EXPECT_EQ(votes({observation}).agreeing, Indices()) << "corner " << i;
    EXPECT_EQ(votes({observation}).contradicting.size(), 1U) << "corner " << i;
  }
}

TEST_P(DetectedTags, CountEachForItself) {
  const Eigen::Vector2d far(6.0, 0.0);
  const TagVotes found =
      votes({observation_of(map_.tags[2]), observation_of(map_.tags[0]), observation_of(map_.tags[1], far)});
  EXPECT_EQ(found.agreeing, Indices({0, 2}));
  EXPECT_EQ(found.contradicting.size(), 1U);
  EXPECT_EQ(
      votes({observation_of(map_.tags[0], far), observation_of(map_.tags[1], far)}).contradicting.size(), 2U);
}

TEST_P(DetectedTags, ThatMayBeFalseAgreeButDoNotContradict) {
  TagObservation corrected = observation_of(map_.tags[0]);
  corrected.corrected_bits = 1;
  EXPECT_EQ(votes({corrected}).agreeing, Indices({0}));
  TagObservation corrected_far = observation_of(map_.tags[0], {6.0, 0.0});
  corrected_far.corrected_bits = 1;
  EXPECT_EQ(votes({corrected_far}).agreeing, Indices());
  EXPECT_EQ(votes({corrected_far}).contradicting.size(), 0U);

  std::vector<TagObservation> copies = {observation_of(map_.tags[0], {60.0, 0.0}),
                                        observation_of(map_.tags[0])};
  for (TagObservation& copy : copies) copy.is_repeated = true;
  EXPECT_EQ(votes(copies).agreeing, Indices({0}));
  EXPECT_EQ(votes(copies).contradicting.size(), 0U);
}

TEST_P(DetectedTags, ContradictAStateThatPutsThemBehindTheCamera) {
  MotionState state = sliding(0.0);
  state.pose = {Eigen::Quaterniond::Identity(), -state.pose.translation()};
  const TagVotes found =
      count_votes(world_, {observation_of(map_.tags[0])}, state, kExposure_s, kSharpSigma_px);
  EXPECT_EQ(found.agreeing, Indices());
  EXPECT_EQ(found.contradicting.size(), 1U);
}

TEST_P(DetectedTags, GiveCornersWithTheNoiseOfTheirPath) {
  std::vector<TagObservation> observations;
  for (const MapTag& tag : map_.tags) observations.push_back(observation_of(tag, {0.3, 0.1}));
  observations[0].corrected_bits = 1;
  observations[2].is_repeated = true;
  for (const double path_px : {0.0, 10.0, 60.0}) {
    const std::vector<CornerObservation> corners =
        corner_observations(world_, observations, sliding(path_px), kExposure_s, kSharpSigma_px);
    ASSERT_EQ(corners.size(), 4U);  // those of the one that was read without a doubt
    for (std::size_t i = 0; i < kNumCorners; ++i) {
      EXPECT_EQ(corners[i].pixel, observations[1].corners_px[i]);
      EXPECT_EQ(corners[i].point_map, observations[1].corners_map[i]);
      EXPECT_NEAR(corners[i].sigma_px, std::hypot(0.2, 0.06 * path_px), 1e-9);
    }
  }
}

TEST(Quorum, IsOfTheTagsThatAgreeOrOfAll) {
  const std::vector<TagEvidence> tags = {{.tag_index = 4}, {.tag_index = 2}, {.tag_index = 9}};
  const auto indices = [&](const TagVotes& votes) {
    Indices result;
    for (const TagEvidence& tag : quorum(tags, votes)) result.push_back(tag.tag_index);
    return result;
  };
  EXPECT_EQ(indices({{}, {}}), Indices({4, 2, 9}));
  EXPECT_EQ(indices({{2, 4}, {}}), Indices({4, 2}));
  EXPECT_EQ(indices({{9}, {5, 6, 7}}), Indices({9}));
  EXPECT_EQ(indices({{7}, {}}), Indices({4, 2, 9}));  // read, but too little of it shows
}

}  // namespace
}  // namespace apriltrack
