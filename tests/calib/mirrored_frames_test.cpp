// Frames that were put where one of their tags, mirrored, would have them; from exact corners.
#include "initialise/mirrored_frames.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <iterator>
#include <set>
#include <vector>

#include "adjusted_world.h"
#include "solve/frame_views.h"
#include "support/pose_matchers.h"

namespace apriltrack {
namespace {

using test::AdjustedWorld;
using test::PoseNear;

/// Puts the view's frame where its tag, seen mirrored, would have it.
void mirror(AdjustedWorld& one, std::size_t v) {
  const TagView& view = one.observations.views[v];
  one.solved.state.T_map_rig[static_cast<std::size_t>(view.frame)] =
      one.solved.state.T_map_tag[static_cast<std::size_t>(view.tag)] *
      one.candidates[v].candidates[1].T_rig_tag.inverse();
}

/// Some frames, each put where one of its tags would have it, seen mirrored.
std::set<int> mirror_some_frames(AdjustedWorld& one, std::size_t every) {
  std::set<int> mirrored;
  for (std::size_t i = 0; i < one.solved.part.views.size(); i += every) {
    const std::size_t v = one.solved.part.views[i];
    if (one.candidates[v].candidates.size() < 2) continue;
    mirror(one, v);
    mirrored.insert(one.observations.views[v].frame);
  }
  return mirrored;
}

/// The first view of each frame alone, which has two poses.
Part first_views(const AdjustedWorld& one) {
  std::vector<std::size_t> views;
  int last_frame = -1;
  for (const std::size_t v : one.offered.views) {
    const int frame = one.observations.views[v].frame;
    if (frame != last_frame) views.push_back(v);
    last_frame = frame;
  }
  return {one.offered.tags, views};
}

void expect_frames_of(const MapState& truth, const AdjustedWorld& one) {
  for (const std::size_t v : one.offered.views) {
    const auto frame = static_cast<std::size_t>(one.observations.views[v].frame);
    EXPECT_THAT(one.solved.state.T_map_rig[frame], PoseNear(truth.T_map_rig[frame], 1e-6, 1e-6)) << frame;
  }
}

TEST(MirroredFrames, AreTurnedBack) {
  AdjustedWorld one(test::make_room(8, 60, test::perspective_camera()));
  const MapState truth = one.solved.state;
  ASSERT_GT(mirror_some_frames(one, 9).size(), 5u);
  EXPECT_TRUE(turn_mirrored_frames(one.task(), one.offered, one.solved.state, parallel_for(2)));
  expect_frames_of(truth, one);
}

// Of a small tag, either pose leaves residuals that look sound.
TEST(MirroredFrames, AreTurnedBackWhereNoViewIsFarOff) {
  AdjustedWorld one(test::make_room(8, 60, test::perspective_camera()));
  one.offered = first_views(one);
  one.solved.state.noise.sum = one.solved.state.noise.difference = 5.0;
  const PartTask task = one.task();
  const MapState truth = one.solved.state;
  int unsuspicious = 0;
  for (const std::size_t v : one.offered.views) {
    if (one.candidates[v].candidates.size() < 2) continue;
    FrameViews frame(task, {v}, one.solved.state);
    const Pose true_pose = frame.pose();
    mirror(one, v);
    frame.settle();
    if (!frame.has_far_view() && frame.cost() > 2.0)
      ++unsuspicious;
    else
      frame.pose() = true_pose;
  }
  ASSERT_GT(unsuspicious, 5);
  EXPECT_TRUE(turn_mirrored_frames(task, one.offered, one.solved.state, parallel_for(2)));
  expect_frames_of(truth, one);
}

TEST(MirroredFrames, OthersStayWhereTheyAre) {
  AdjustedWorld one(test::make_room(8, 60, test::perspective_camera()));
  const MapState before = one.solved.state;
  EXPECT_FALSE(turn_mirrored_frames(one.task(), one.offered, one.solved.state, parallel_for(2)));
  for (std::size_t i = 0; i < before.T_map_rig.size(); ++i)
    EXPECT_THAT(one.solved.state.T_map_rig[i], PoseNear(before.T_map_rig[i], 0.0, 0.0));
}

}  // namespace
}  // namespace apriltrack
