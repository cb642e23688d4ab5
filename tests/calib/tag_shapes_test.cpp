// Sizes and bends of a few parts in a hundred, from corners with the noise that a detector has.
#include "faults/tag_shapes.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "adjusted_world.h"
#include "faults/view_spread.h"

namespace apriltrack {
namespace {

using test::AdjustedWorld;
using test::SyntheticWorld;

constexpr int kOdd = 9;
using Moved = std::function<Eigen::Vector3d(Eigen::Vector3d, std::size_t)>;

SyntheticWorld sound_room() {
  return test::make_room(10, 80, test::perspective_camera());
}

std::optional<TagFinding> finding_of(const Moved& moved, double noise_px = 0.1, std::uint64_t seed = 5) {
  const SyntheticWorld world = sound_room();
  std::vector<FrameDetections> frames = test::filmed_with(world, kOdd, moved);
  RandomStream random(seed);
  test::add_edge_noise(frames, noise_px, -0.45, random);
  const AdjustedWorld one(world, frames, {.corner_bias_px = 0.02});
  const auto finding = find_odd_shape(one.task(), one.solved);
  if (finding) {
    EXPECT_EQ(finding->tag, one.index_of(kOdd));
  }
  return finding;
}

TEST(TagShapes, FindTheSizeThatATagHas) {
  const auto larger = finding_of([](const Eigen::Vector3d& corner, std::size_t) { return 1.015 * corner; });
  ASSERT_TRUE(larger);
  EXPECT_TRUE(larger->is_left_out);
  EXPECT_NEAR(std::exp(larger->log_scale()), 1.015, 0.003);
  const auto smaller = finding_of([](const Eigen::Vector3d& corner, std::size_t) { return 0.98 * corner; });
  ASSERT_TRUE(smaller);
  EXPECT_NEAR(std::exp(smaller->log_scale()), 0.98, 0.0035);
}

TEST(TagShapes, FindAPrintThatIsNotSquare) {
  const auto finding = finding_of([](Eigen::Vector3d corner, std::size_t) {
    corner.x() *= 0.98;
    return corner;
  });
  ASSERT_TRUE(finding);
  EXPECT_FALSE(finding->is_left_out);
  ASSERT_TRUE(finding->shape && finding->shape->is_aspect_clear);
  EXPECT_NEAR(finding->shape->aspect, -0.02, 0.0045);
}

/// Without the views of the tag from over 4 degrees aside of the one that has most others near.
void show_from_one_side(const SyntheticWorld& world, std::vector<FrameDetections>& frames) {
  constexpr double kAside_rad = 0.07;
  const MapTag& tag = *world.map.find({"tag36h11", kOdd});
  const auto shows = [&](std::size_t i) {
    return std::ranges::any_of(frames[i].detections, [&](const auto& one) { return one.tag == tag.key; });
  };
  std::vector<Eigen::Vector3d> directions;
  for (const Pose& T_world_rig : world.T_world_rig)
    directions.push_back((tag.T_map_tag.inverse() * T_world_rig).translation().normalized());
  std::vector<std::size_t> kept;
  for (std::size_t own = 0; own < frames.size(); ++own) {
    std::vector<std::size_t> near;
    for (std::size_t i = 0; i < frames.size(); ++i)
      if (shows(i) && directions[i].dot(directions[own]) > std::cos(kAside_rad)) near.push_back(i);
    if (near.size() > kept.size()) kept = near;
  }
  EXPECT_GE(kept.size(), 8U);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (!std::ranges::binary_search(kept, i))
      std::erase_if(frames[i].detections, [&](const auto& one) { return one.tag == tag.key; });
  }
}

/// Its aspect goes with its tilt, and so does an error that all of its pictures share.
TEST(TagShapes, DoNotAccuseATagOfABendThatIsSeenFromOneSide) {
  const SyntheticWorld world = sound_room();
  std::vector<FrameDetections> frames =
      test::filmed_with(world, kOdd, [](Eigen::Vector3d corner, std::size_t) {
        corner.x() *= 0.96;
        return corner;
      });
  RandomStream random(5);
  test::add_edge_noise(frames, 0.1, -0.45, random);
  show_from_one_side(world, frames);
  const AdjustedWorld one(world, frames, {.corner_bias_px = 0.02});
  const auto finding = find_odd_shape(one.task(), one.solved);
  EXPECT_FALSE(finding && finding->kind == TagFinding::Kind::kNotFlat);
  for (const int tag : one.solved.part.tags)
    EXPECT_EQ(is_seen_from_one_side(one.observations, one.solved.part.views, one.solved.state, tag),
              tag == one.index_of(kOdd));
}

TEST(TagShapes, FindATwist) {
  const double lift_m = 0.0024;
  const auto finding = finding_of([&](Eigen::Vector3d corner, std::size_t) {
    corner.z() += (corner.x() > 0.0) == (corner.y() > 0.0) ? lift_m : -lift_m;
    return corner;
  });
  ASSERT_TRUE(finding);
  ASSERT_TRUE(finding->shape && finding->shape->is_twist_clear);
  EXPECT_NEAR(std::abs(finding->shape->twist) * finding->shape->size_m, lift_m, 0.0004);
}

// Narrower, and twisted, each so little that its number by itself may be chance.
TEST(TagShapes, FindABendThatItsNumbersShowOnlyTogether) {
  int found = 0, told = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const auto finding = finding_of(
        [](Eigen::Vector3d corner, std::size_t) {
          corner.z() += (corner.x() > 0.0) == (corner.y() > 0.0) ? 0.0012 : -0.0012;
          corner.x() *= 0.985;
          return corner;
        },
        0.25, seed);
    found += finding && finding->kind == TagFinding::Kind::kNotFlat ? 1 : 0;
    told += finding && finding->shape && finding->shape->is_clear_together ? 1 : 0;
  }
  // Of 60 draws 36 and 19.
  EXPECT_GE(found, 8);
  EXPECT_GE(told, 3);
}

TEST(TagShapes, AreAsStatedWhereCornersAreAndWhereTheyErr) {
  EXPECT_FALSE(finding_of([](const Eigen::Vector3d& corner, std::size_t) { return corner; }));
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const SyntheticWorld world = sound_room();
    std::vector<FrameDetections> frames = test::exact_detections(world);
    RandomStream random(seed);
    test::add_edge_noise(frames, 0.2, -0.45, random);
    test::add_edge_biases(frames, 0.05, -0.45, random);
    const AdjustedWorld one(world, frames);
    EXPECT_FALSE(find_odd_shape(one.task(), one.solved)) << seed;
  }
}

/// Three tags side by side on a wall, and a camera that looks at them from many sides.
SyntheticWorld wall() {
  SyntheticWorld world;
  for (const double x_m : {-0.5, 0.0, 0.5})
    test::add_tag(world, 0.2, test::looking_along({x_m, 0.0, 0.1 * x_m}, {0.0, 1.0, 0.0}));
  world.rig.cameras.push_back(test::perspective_camera());
  for (int k = 0; k < 60; ++k) {
    const Eigen::Vector3d from(1.2 * std::cos(0.7 * k), -1.6 - 0.4 * std::cos(0.9 * k), std::sin(1.1 * k));
    world.T_world_rig.push_back(test::looking_along(from, -from));
  }
  return world;
}

/// Tags of the wall that are larger than stated by these shares.
std::optional<TagFinding> finding_of_sizes(const std::array<double, 3>& shares) {
  SyntheticWorld printed = wall();
  for (std::size_t i = 0; i < shares.size(); ++i) printed.map.tags[i].size_m *= 1.0 + shares[i];
  std::vector<FrameDetections> frames = test::exact_detections(printed);
  RandomStream random(3);
  test::add_edge_noise(frames, 0.05, -0.45, random);
  const AdjustedWorld one(wall(), frames);
  return find_odd_shape(one.task(), one.solved);
}

// What a lens that is not known well leaves: none of a few tags is as stated.
TEST(TagShapes, BlameNoTagOfThreeWhereNoneIsAsStated) {
  EXPECT_FALSE(finding_of_sizes({0.0, -0.008, 0.008}));
  EXPECT_FALSE(finding_of_sizes({0.0, -0.004, 0.012}));
}

TEST(TagShapes, BlameNoTagWhereManyAreOdd) {
  SyntheticWorld printed = sound_room();
  for (std::size_t i = 0; i < printed.map.tags.size(); ++i)
    printed.map.tags[i].size_m *= i % 2 == 0 ? 0.98 : 1.02;
  const AdjustedWorld one(sound_room(), test::exact_detections(printed));
  EXPECT_FALSE(find_odd_shape(one.task(), one.solved));
}

}  // namespace
}  // namespace apriltrack
