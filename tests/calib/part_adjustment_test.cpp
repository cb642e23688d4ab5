// The adjustment of a part from exact corners: what a lens does not reach.
#include "initialise/part_adjustment.h"

#include <gmock/gmock.h>

#include <set>
#include <vector>

#include "adjusted_world.h"
#include "faults/part_without.h"

namespace apriltrack {
namespace {

using test::AdjustedWorld;
using ::testing::HasSubstr;

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

}  // namespace
}  // namespace apriltrack
