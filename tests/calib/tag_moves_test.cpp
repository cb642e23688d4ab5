// Tags that moved in frames that show two tags each, of which any pose explains much: what all views tell.
#include "faults/tag_moves.h"

#include <gmock/gmock.h>

#include "adjusted_world.h"
#include "apriltrack/base/degrees.h"

namespace apriltrack {
namespace {

using test::AdjustedWorld;
using test::SyntheticWorld;

constexpr int kMovedTag = 11;
constexpr std::size_t kNumFrames = 120;

/// Where the tag is in its own frame by then.
using Motion = std::function<Pose(std::size_t)>;

/// A room in which frames show the two tags alone that are largest, with a noise of 0.1 px.
AdjustedWorld filmed_in_pairs(const Motion& motion, std::uint64_t seed) {
  const SyntheticWorld world = test::make_room(9, static_cast<int>(kNumFrames), test::equidistant_camera());
  std::vector<FrameDetections> frames = test::filmed_with(
      world, kMovedTag, [&](const Eigen::Vector3d& corner, std::size_t i) { return motion(i) * corner; });
  for (std::size_t i = 0; i < frames.size(); ++i) {
    auto& detections = frames[i].detections;
    std::ranges::sort(detections, {}, [&](const Detection& one) { return (one.tag.id + i) % 9; });
    if (detections.size() > 2) detections.resize(2);
  }
  RandomStream random(seed);
  test::add_edge_noise(frames, 0.1, -0.45, random);
  return {world, frames};
}

/// About the tag's own axes: x right, y down, z into it.
Pose turned(int axis, double degrees) {
  Vector6d xi = Vector6d::Zero();
  xi[3 + axis] = degrees * kRadPerDeg;
  return Pose::exp(xi);
}

void expect_loose(const AdjustedWorld& one) {
  const auto finding = find_hidden_move(one.task(), one.solved, parallel_for(1));
  ASSERT_TRUE(finding);
  EXPECT_EQ(finding->tag, one.index_of(kMovedTag));
  EXPECT_EQ(finding->kind, TagFinding::Kind::kLoose);
}

TEST(HiddenMoves, NameATagThatWasTurned) {
  const AdjustedWorld one =
      filmed_in_pairs([](std::size_t i) { return i < kNumFrames / 2 ? Pose() : turned(1, 8.0); }, 61);
  const auto finding = find_hidden_move(one.task(), one.solved, parallel_for(1));
  ASSERT_TRUE(finding);
  EXPECT_EQ(finding->tag, one.index_of(kMovedTag));
  EXPECT_EQ(finding->kind, TagFinding::Kind::kMoved);
  EXPECT_TRUE(finding->is_left_out);
  ASSERT_TRUE(finding->places);
  EXPECT_TRUE(finding->places->is_one_after_other);
  EXPECT_NEAR(
      rotation_angle_rad(finding->places->T_first_second.rotation(), turned(1, 0.0).rotation()) * kDegPerRad,
      8.0, 1.0);
}

/// By so little that, by the noise which the move itself makes, it might be chance.
TEST(HiddenMoves, AreJudgedByTheNoiseOfTwoPlaces) {
  for (std::uint64_t seed = 61; seed < 65; ++seed) {
    const AdjustedWorld one =
        filmed_in_pairs([](std::size_t i) { return i < kNumFrames / 2 ? Pose() : turned(2, 3.0); }, seed);
    const auto finding = find_hidden_move(one.task(), one.solved, parallel_for(1));
    ASSERT_TRUE(finding) << seed;
    EXPECT_EQ(finding->tag, one.index_of(kMovedTag)) << seed;
    EXPECT_EQ(finding->kind, TagFinding::Kind::kMoved) << seed;
  }
}

TEST(HiddenMoves, NameATagThatFlaps) {
  const AdjustedWorld one = filmed_in_pairs(
      [](std::size_t i) { return turned(0, 10.0 * std::sin(0.31 * static_cast<double>(i))); }, 62);
  expect_loose(one);
}

/// By so little, and so often, that no two moments tell.
TEST(HiddenMoves, NameATagThatTrembles) {
  const AdjustedWorld one = filmed_in_pairs(
      [](std::size_t i) { return turned(0, 5.0 * std::sin(0.9 * static_cast<double>(i))); }, 63);
  expect_loose(one);
}

TEST(HiddenMoves, AreAskedOfSomeTagsAlone) {
  const AdjustedWorld one = filmed_in_pairs(
      [](std::size_t i) { return turned(0, 5.0 * std::sin(0.9 * static_cast<double>(i))); }, 63);
  const int moved = one.index_of(kMovedTag);
  EXPECT_TRUE(do_move_again(one.task(), one.solved, {moved, moved + 1}, parallel_for(1)));
  EXPECT_FALSE(do_move_again(one.task(), one.solved, {moved + 1, moved + 2}, parallel_for(1)));
}

/// By too little to be told of a tag of which nothing is known.
TEST(HiddenMoves, AreSoonerClearOfATagThatDidMove) {
  const AdjustedWorld one = filmed_in_pairs(
      [](std::size_t i) { return turned(0, 2.5 * std::sin(0.5 * static_cast<double>(i))); }, 64);
  const int moved = one.index_of(kMovedTag);
  EXPECT_FALSE(find_hidden_move(one.task(), one.solved, parallel_for(1)));
  EXPECT_TRUE(do_move_again(one.task(), one.solved, {moved}, parallel_for(1)));
}

TEST(HiddenMovesStatistics, AreNoneWhereNothingMoved) {
  for (std::uint64_t seed = 70; seed < 90; ++seed) {
    const AdjustedWorld one = filmed_in_pairs([](std::size_t) { return Pose(); }, seed);
    EXPECT_FALSE(find_hidden_move(one.task(), one.solved, parallel_for(1))) << seed;
  }
}

}  // namespace
}  // namespace apriltrack
