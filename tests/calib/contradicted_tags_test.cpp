// Tags of which more views were rejected than kept, from exact corners: which go, and that the others stay
// right.
#include "contradicted_tags.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "calibrating.h"

namespace apriltrack {
namespace {

using test::SyntheticWorld;

/// A part as it was offered, and adjusted to the views that are left of it.
struct Case {
  SyntheticWorld world = test::make_room(6, 60, test::perspective_camera());
  Findings findings;
  CalibrationOptions options;
  Observations observations =
      collect_observations(test::exact_detections(world), world.rig, world.sizes(), options, findings);
  std::vector<ViewCandidates> candidates;
  Part offered;
  AdjustedPart solved;

  Case() {
    std::vector<std::size_t> views(observations.views.size());
    std::iota(views.begin(), views.end(), std::size_t{0});
    candidates = solve_views(observations, views, parallel_for(1));
    offered = find_parts(observations, views, options.min_views).parts.front();
    solved = adjust_part(task(), offered, offered.tags.front(), parallel_for(1));
  }

  PartTask task() const { return {observations, candidates, options}; }

  /// Of every four views of a tag, `rejected` are; the rest of the map stays.
  void reject(int tag, int rejected) {
    int rank = 0;
    std::erase_if(solved.part.views,
                  [&](std::size_t v) { return observations.views[v].tag == tag && rank++ % 4 < rejected; });
  }
};

TEST(ContradictedTags, GoWhereMostOfTheirViewsWereRejected) {
  Case one;
  const int tag = one.offered.tags[3];
  one.reject(tag, 3);
  EXPECT_EQ(leave_out_contradicted(one.task(), one.offered, one.solved), std::vector{tag});
  std::vector<int> others = one.offered.tags;
  std::erase(others, tag);
  EXPECT_EQ(one.solved.part.tags, others);
}

TEST(ContradictedTags, StayWhereFewerWere) {
  Case one;
  one.reject(one.offered.tags[3], 1);
  EXPECT_TRUE(leave_out_contradicted(one.task(), one.offered, one.solved).empty());
  EXPECT_EQ(one.solved.part.tags, one.offered.tags);
}

TEST(ContradictedTags, LeaveTheGaugeToAnotherUnlessTheUserHoldsThem) {
  Case one;
  const int held = one.solved.held_tag;
  one.reject(held, 3);
  Case other = one;
  other.options.held_tag = other.observations.tags[static_cast<std::size_t>(held)];
  EXPECT_EQ(leave_out_contradicted(one.task(), one.offered, one.solved), std::vector{held});
  EXPECT_NE(one.solved.held_tag, held);
  EXPECT_TRUE(leave_out_contradicted(other.task(), other.offered, other.solved).empty());
  EXPECT_EQ(other.solved.held_tag, held);
}

}  // namespace
}  // namespace apriltrack
