// What of a chain of tags, each seen with the next, hangs together when some are left out.
#include "faults/part_without.h"

#include <gmock/gmock.h>

#include <iterator>

#include "adjusted_world.h"
#include "support/pose_matchers.h"

namespace apriltrack {
namespace {

using test::AdjustedWorld;
using test::PoseNear;
using test::SyntheticWorld;
using ::testing::ElementsAre;

constexpr int kTagsInARow = 6;

/// Six tags in a row on a wall, filmed from two metres.
SyntheticWorld row() {
  SyntheticWorld world;
  for (int i = 0; i < kTagsInARow; ++i)
    test::add_tag(world, 0.2, test::looking_along({0.4 * i, 2.0, 0.1 * (i % 2)}, {0.1 * (i % 3), 1.0, 0.0}));
  world.rig.cameras.push_back(test::perspective_camera());
  for (int k = 0; k < 60; ++k)
    world.T_world_rig.push_back(test::looking_along(
        {1.0 + 0.8 * std::sin(1.1 * k), 0.2 * std::cos(0.7 * k), 0.5 * std::sin(0.9 * k)}, {0.0, 1.0, 0.0}));
  return world;
}

/// Frames show two neighbours each.
AdjustedWorld chain() {
  std::vector<FrameDetections> frames = test::exact_detections(row());
  test::show_two_neighbours(kTagsInARow, frames);
  return {row(), frames};
}

TEST(PartWithout, IsTheLargerPieceHeldByAnother) {
  const AdjustedWorld one = chain();
  ASSERT_THAT(one.offered.tags, ElementsAre(0, 1, 2, 3, 4, 5));
  const auto rest = part_without(one.task(), one.offered, {2}, 0);
  ASSERT_TRUE(rest);
  EXPECT_THAT(rest->part.tags, ElementsAre(3, 4, 5));
  EXPECT_EQ(rest->held_tag, 3);
}

TEST(PartWithout, KeepsTheHeldTagWhereItCan) {
  const AdjustedWorld one = chain();
  const auto rest = part_without(one.task(), one.offered, {4}, 2);
  ASSERT_TRUE(rest);
  EXPECT_THAT(rest->part.tags, ElementsAre(0, 1, 2, 3));
  EXPECT_EQ(rest->held_tag, 2);
}

TEST(PartWithout, IsTheUsersPieceHoweverSmall) {
  AdjustedWorld one = chain();
  one.options.held_tag = one.observations.tags[0];
  const auto rest = part_without(one.task(), one.offered, {2}, 0);
  ASSERT_TRUE(rest);
  EXPECT_THAT(rest->part.tags, ElementsAre(0, 1));
  EXPECT_FALSE(part_without(one.task(), one.offered, {1}, 0));  // one tag is no map
  EXPECT_FALSE(part_without(one.task(), one.offered, {0}, 0));
}

TEST(PartWithout, IsNoneWhereNoTwoConnect) {
  const AdjustedWorld one = chain();
  EXPECT_FALSE(part_without(one.task(), one.offered, {1, 3, 5}, 0));
}

TEST(AdjustWithout, TurnsTheMapIntoTheFrameOfTheTagThatIsHeldThen) {
  AdjustedWorld one = chain();
  ASSERT_TRUE(adjust_without(one.task(), one.offered, {2}, one.solved));
  EXPECT_EQ(one.solved.held_tag, 3);
  for (const int tag : one.solved.part.tags) {
    const TagKey key = one.observations.tags[static_cast<std::size_t>(tag)];
    EXPECT_THAT(one.solved.state.T_map_tag[static_cast<std::size_t>(tag)],
                PoseNear(test::T_origin_tag(one.world.map, one.observations.tags[3], key), 1e-6, 1e-6));
  }
}

}  // namespace
}  // namespace apriltrack
