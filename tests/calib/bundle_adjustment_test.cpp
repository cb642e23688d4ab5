// The adjustment from starts that are hard on it; from corners whose noise is known.
#include "solve/bundle_adjustment.h"

#include <gtest/gtest.h>

#include <cmath>

#include "adjusted_world.h"
#include "apriltrack/base/degrees.h"

namespace apriltrack {
namespace {

using test::AdjustedWorld;

constexpr int kTagsOnWall = 10;

/// Small tags on one wall, each frame seeing some, nearly head-on and from far.
test::SyntheticWorld make_far_wall() {
  test::SyntheticWorld world;
  world.rig.cameras = {test::perspective_camera()};
  for (int i = 0; i < kTagsOnWall; ++i)
    test::add_tag(world, 0.06, test::looking_along({0.45 * i, 5.0, 0.3 * (i % 3)}, {0.0, 1.0, 0.0}));
  for (int i = 0; i < 60; ++i) {
    const Eigen::Vector3d eye(4.5 * i / 60.0, 0.8 * std::sin(0.7 * i), 0.6 * std::cos(0.9 * i));
    world.T_world_rig.push_back(test::looking_along(eye, {0.2 * std::sin(1.3 * i), 1.0, 0.0}));
  }
  return world;
}

/// Turned about a point so far before it by a random angle about a random axis across its own z.
void disturb(Pose& pose, double distance_m, RandomStream& random) {
  const Pose there(Eigen::Quaterniond::Identity(), {0.0, 0.0, distance_m});
  Vector6d off;
  for (int i = 0; i < 6; ++i) off[i] = (i < 3 ? 0.03 : 40.0 * kRadPerDeg) * random.normal();
  off[5] = 0.0;
  pose = pose * there * Pose::exp(off) * there.inverse();
}

// Between its two poses a frame of small tags is linear nowhere near: the steps that it allows are short, and
// all others would have to take them, too. Of these 12 starts plain steps, 100 of them, reach a minimum
// from 7; these from all.
TEST(BundleAdjustment, FramesBetweenTwoPosesDoNotHoldUpTheOthers) {
  const test::SyntheticWorld world = make_far_wall();
  std::vector<FrameDetections> frames = exact_detections(world);
  test::show_two_neighbours(kTagsOnWall, frames);
  RandomStream noise(5);
  test::add_edge_noise(frames, 0.25, 0.0, noise);
  const AdjustedWorld one(world, frames);
  int converged = 0;
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    MapState state = one.solved.state;
    RandomStream random(seed);
    for (const int tag : free_tags(one.solved.part, one.solved.held_tag))
      disturb(state.T_map_tag[static_cast<std::size_t>(tag)], 0.0, random);
    for (Pose& pose : state.T_map_rig) disturb(pose, 5.0, random);
    const auto adjusted =
        adjust(one.observations, one.solved.part.views, free_tags(one.solved.part, one.solved.held_tag),
               {.loss_scale = 0.0, .max_iterations = 100}, state);
    converged += adjusted.has_converged ? 1 : 0;
  }
  EXPECT_GE(converged, 11);
}

}  // namespace
}  // namespace apriltrack
