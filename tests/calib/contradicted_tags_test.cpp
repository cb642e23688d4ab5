// Tags of which more views were rejected than kept, from exact corners: which go, and that the others stay
// right.
#include "contradicted_tags.h"

#include <gtest/gtest.h>

#include "adjusted_world.h"

namespace apriltrack {
namespace {

using test::AdjustedWorld;

struct Case : AdjustedWorld {
  Case() : AdjustedWorld(test::make_room(6, 60, test::perspective_camera())) {}

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
