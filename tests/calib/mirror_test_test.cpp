// Tags, and groups of them, that lie where they seem to when mirrored: which turn back, and which stay open.
#include "initialise/mirror_test.h"

#include <gmock/gmock.h>

#include "adjusted_world.h"
#include "apriltrack/base/degrees.h"
#include "apriltrack/geometry/rotation.h"
#include "calibrating.h"
#include "faults/part_without.h"
#include "hypotheses/undecided_tags.h"
#include "initialise/hinge_starts.h"
#include "support/pose_matchers.h"

namespace apriltrack {
namespace {

using test::AdjustedWorld;
using test::PoseNear;
using test::SyntheticWorld;
using ::testing::ElementsAre;

constexpr int kTagsOfChain = 6;

/// Six tags in a row on a wall, filmed from far, and nearly from the front.
SyntheticWorld front_row() {
  SyntheticWorld world;
  for (int i = 0; i < kTagsOfChain; ++i)
    test::add_tag(world, 0.2,
                  test::looking_along({0.4 * i, 2.0, 0.1 * (i % 2)}, {0.3 + 0.1 * (i % 3), 1.0, 0.2}));
  world.rig.cameras.push_back(test::perspective_camera());
  for (int k = 0; k < 60; ++k)
    world.T_world_rig.push_back(test::looking_along(
        {1.0 + 0.3 * std::sin(1.1 * k), 0.1 * std::cos(0.7 * k) - 1.0, 0.2 * std::sin(0.9 * k)},
        {0.0, 1.0, 0.0}));
  return world;
}

/// Frames show two neighbours each.
AdjustedWorld chain_from_the_front() {
  std::vector<FrameDetections> frames = test::exact_detections(front_row());
  test::show_two_neighbours(kTagsOfChain, frames);
  RandomStream random(51);
  test::add_edge_noise(frames, 0.1, -0.45, random);
  return {front_row(), frames};
}

/// What takes a tag to where it seems to lie when it is mirrored about the line of sight from the front.
Pose mirroring(const AdjustedWorld& one, int tag) {
  const Pose& pose = one.solved.state.T_map_tag[static_cast<std::size_t>(tag)];
  const Eigen::Vector3d from =
      one.solved.state.T_map_rig[static_cast<std::size_t>(one.observations.views.front().frame)]
          .translation();
  return mirrored_about(pose, from - pose.translation()) * pose.inverse();
}

void move_tags(const Pose& motion, const std::vector<int>& tags, MapState& state) {
  for (const int tag : tags) {
    Pose& pose = state.T_map_tag[static_cast<std::size_t>(tag)];
    pose = motion * pose;
  }
}

void expect_tags(const MapState& found, const MapState& expected) {
  // What a fit of these views leaves to chance: a few millimetres and a degree along six tags of a chain.
  for (std::size_t i = 0; i < kTagsOfChain; ++i)
    EXPECT_THAT(found.T_map_tag[i], PoseNear(expected.T_map_tag[i], 0.01, 0.02)) << i;
}

TEST(MirrorTest, TurnsATagBack) {
  AdjustedWorld one(front_row());
  const MapState truth = one.solved.state;
  move_tags(mirroring(one, 2), {2}, one.solved.state);
  ASSERT_GT(rotation_angle_rad(one.solved.state.T_map_tag[2].rotation(), truth.T_map_tag[2].rotation()),
            5.0 * kRadPerDeg);
  EXPECT_TRUE(turn_mirrored_groups(one.task(), one.solved.part, 0, one.solved.state, parallel_for(1)));
  expect_tags(one.solved.state, truth);
}

TEST(MirrorTest, LeavesWhatIsRightAsItIs) {
  AdjustedWorld one = chain_from_the_front();
  const MapState truth = one.solved.state;
  EXPECT_FALSE(turn_mirrored_groups(one.task(), one.solved.part, 0, one.solved.state, parallel_for(1)));
  for (std::size_t i = 0; i < kTagsOfChain; ++i)
    EXPECT_EQ(one.solved.state.T_map_tag[i].matrix(), truth.T_map_tag[i].matrix());
}

/// Three large tags about a small one, all seen from one place only.
AdjustedWorld with_a_small_tag() {
  SyntheticWorld world;
  test::add_tag(world, 0.5, test::looking_along({-0.6, 2.0, 0.0}, {0.5, 1.0, 0.2}));
  test::add_tag(world, 0.05, test::looking_along({0.0, 2.5, 0.0}, {0.2, 1.0, 0.1}));
  test::add_tag(world, 0.5, test::looking_along({0.6, 2.0, 0.1}, {-0.5, 1.0, -0.3}));
  test::add_tag(world, 0.5, test::looking_along({0.0, 2.2, 0.6}, {0.1, 1.0, 0.4}));
  world.rig.cameras.push_back(test::perspective_camera());
  for (int k = 0; k < 12; ++k)
    world.T_world_rig.push_back(
        test::looking_along({0.02 * std::sin(1.1 * k), 0.02 * std::cos(0.7 * k), 0.0}, {0.0, 1.0, 0.0}));
  std::vector<FrameDetections> frames = test::exact_detections(world);
  RandomStream random(52);
  test::add_edge_noise(frames, 0.3, -0.45, random);
  return {world, frames, {.same_place_px = 0.0}};
}

TEST(UndecidedTags, AreTakenOut) {
  AdjustedWorld one = with_a_small_tag();
  ASSERT_THAT(one.solved.part.tags, ElementsAre(0, 1, 2, 3));
  EXPECT_FALSE(leave_out_undecided(one.task(), one.offered, one.solved, parallel_for(1)));
  EXPECT_THAT(one.solved.undecided, ElementsAre(1));
  EXPECT_THAT(one.solved.part.tags, ElementsAre(0, 2, 3));
}

TEST(UndecidedTags, BringNoTagBackThatWasLeftOutBefore) {
  AdjustedWorld one = with_a_small_tag();
  ASSERT_TRUE(adjust_without(one.task(), one.offered, {3}, one.solved));
  EXPECT_FALSE(leave_out_undecided(one.task(), one.offered, one.solved, parallel_for(1)));
  EXPECT_THAT(one.solved.undecided, ElementsAre(1));
  EXPECT_THAT(one.solved.part.tags, ElementsAre(0, 2));
}

constexpr std::size_t kTagsOfFarChain = 8;

/// How many tags of a chain, 22 px wide, filmed from afar in frames of two, are mapped within what the map
/// states of them.
std::size_t num_right_of_far_chain(std::uint64_t seed) {
  constexpr int kTags = kTagsOfFarChain;
  RandomStream random(seed);
  SyntheticWorld world;
  for (int i = 0; i < kTags; ++i) {
    const Eigen::Vector3d place{0.27 * i, 3.3 + 0.1 * random.normal(), 0.06 * random.normal()};
    const Eigen::Vector3d normal{0.15 * random.normal(), 1.0, 0.15 * random.normal()};
    test::add_tag(world, 0.12, test::looking_along(place, normal));
  }
  world.rig.cameras.push_back(test::perspective_camera());
  for (int k = 0; k < 8 * (kTags - 1); ++k) {
    const double x = 0.27 * (k % (kTags - 1)) + 0.13;
    const Eigen::Vector3d eye{x + 0.5 * random.normal(), 0.2 * std::sin(1.3 * k), 0.5 * random.normal()};
    world.T_world_rig.push_back(test::looking_along(eye, Eigen::Vector3d(x, 3.3, 0.0) - eye));
  }
  std::vector<FrameDetections> frames = test::exact_detections(world);
  test::show_two_neighbours(kTags, frames);
  test::add_edge_noise(frames, 0.2, -0.45, random);
  const CalibrationResult result = test::calibrate(world, frames);
  std::size_t right = 1;  // the held one
  for (const MapTag& tag : result.map.tags) {
    if (tag.key == result.held_tag) continue;
    if (test::squared_sigmas_off(world, result.held_tag, tag) / 6.0 < 4.0) ++right;
  }
  return right;
}

// The tags around a mirrored one give way, until no tag's mirrored pose agrees with the map.
TEST(MirrorTest, TurnsTagsBackThatBentTheMap) {
  for (const std::uint64_t seed : {49, 50, 51, 52, 53})
    EXPECT_EQ(num_right_of_far_chain(seed), kTagsOfFarChain) << seed;
}

}  // namespace
}  // namespace apriltrack
