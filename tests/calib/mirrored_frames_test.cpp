// Frames that were put where one of their tags, mirrored, would have them; from exact corners.
#include "mirrored_frames.h"

#include <gmock/gmock.h>

#include "adjusted_world.h"
#include "support/pose_matchers.h"

namespace apriltrack {
namespace {

using test::AdjustedWorld;
using test::PoseNear;

TEST(MirroredFrames, AreTurnedBack) {
  AdjustedWorld one(test::make_room(8, 60, test::perspective_camera()));
  const MapState truth = one.solved.state;
  int mirrored = 0;
  for (std::size_t i = 0; i < one.solved.part.views.size(); i += 9) {
    const std::size_t v = one.solved.part.views[i];
    const TagView& view = one.observations.views[v];
    if (one.candidates[v].candidates.size() < 2) continue;
    one.solved.state.T_map_rig[static_cast<std::size_t>(view.frame)] =
        truth.T_map_tag[static_cast<std::size_t>(view.tag)] *
        one.candidates[v].candidates[1].T_rig_tag.inverse();
    ++mirrored;
  }
  ASSERT_GT(mirrored, 5);
  EXPECT_TRUE(turn_mirrored_frames(one.task(), one.offered, one.solved.state));
  for (const std::size_t v : one.offered.views) {
    const auto frame = static_cast<std::size_t>(one.observations.views[v].frame);
    EXPECT_THAT(one.solved.state.T_map_rig[frame], PoseNear(truth.T_map_rig[frame], 1e-6, 1e-6)) << frame;
  }
}

TEST(MirroredFrames, OthersStayWhereTheyAre) {
  AdjustedWorld one(test::make_room(8, 60, test::perspective_camera()));
  const MapState before = one.solved.state;
  EXPECT_FALSE(turn_mirrored_frames(one.task(), one.offered, one.solved.state));
  for (std::size_t i = 0; i < before.T_map_rig.size(); ++i)
    EXPECT_THAT(one.solved.state.T_map_rig[i], PoseNear(before.T_map_rig[i], 0.0, 0.0));
}

}  // namespace
}  // namespace apriltrack
