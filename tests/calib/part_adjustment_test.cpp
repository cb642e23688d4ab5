// The adjustment of a part from exact corners: what a lens does not reach, and what was left out by a wrong
// lens.
#include "initialise/part_adjustment.h"

#include <gmock/gmock.h>

#include <set>
#include <vector>

#include "adjusted_world.h"
#include "faults/part_without.h"
#include "hypotheses/better_cameras.h"

namespace apriltrack {
namespace {

using test::AdjustedWorld;
using test::SyntheticWorld;
using ::testing::HasSubstr;

SyntheticWorld with_focal_length(SyntheticWorld world, double factor) {
  CameraModel& model = world.rig.cameras[0].model;
  Pinhole pinhole = model.pinhole();
  pinhole.fx *= factor;
  pinhole.fy *= factor;
  model = CameraModel(pinhole, model.distortion());
  return world;
}

TEST(AdjustPart, LeavesOutATagOfWhichNoViewHasAPose) {
  AdjustedWorld one(test::make_room(8, 60, test::perspective_camera()));
  const int unreached = one.offered.tags[3];
  for (std::size_t v = 0; v < one.candidates.size(); ++v)
    if (one.observations.views[v].tag == unreached) one.candidates[v].candidates.clear();
  auto anew = adjust_part(one.task(), one.offered, one.solved.held_tag, parallel_for(1));
  ASSERT_TRUE(anew);
  std::vector<int> others = one.offered.tags;
  std::erase(others, unreached);
  EXPECT_EQ(anew->part.tags, others);
}

TEST(AdjustPart, RefusesAPartOfWhichNoViewHasAPose) {
  AdjustedWorld one(test::make_room(8, 60, test::perspective_camera()));
  for (ViewCandidates& view : one.candidates) view.candidates.clear();
  const auto anew = adjust_part(one.task(), one.offered, one.solved.held_tag, parallel_for(1));
  ASSERT_FALSE(anew);
  EXPECT_THAT(anew.why().cause, HasSubstr("contradict each other"));
}

TEST(AdjustWithout, CountsTheContradictionsAnew) {
  AdjustedWorld one(test::make_room(8, 60, test::perspective_camera()));
  one.solved.contradictions.tags = {one.offered.tags[2]};
  ASSERT_TRUE(adjust_without(one.task(), one.offered, {one.offered.tags[3]}, one.solved));
  EXPECT_FALSE(one.solved.contradictions.are_there());
}

TEST(ImproveCameras, TakesBackWhatOnlyTheFilesLensContradicts) {
  const SyntheticWorld truth = test::make_room(8, 120, test::perspective_camera());
  AdjustedWorld one(with_focal_length(truth, 1.02), test::exact_detections(truth));
  const std::set<int> accused{one.offered.tags[3], one.offered.tags[6]};
  ASSERT_TRUE(adjust_without(one.task(), one.offered, accused, one.solved));
  one.solved.culprits.assign(accused.begin(), accused.end());
  const BetterCameras cameras =
      improve_cameras(one.task(), one.offered, parallel_for(1), silent_log(), one.solved);
  ASSERT_TRUE(cameras.refined.is_accepted);
  EXPECT_TRUE(one.solved.culprits.empty());
  EXPECT_EQ(one.solved.part.tags, one.offered.tags);
}

}  // namespace
}  // namespace apriltrack
