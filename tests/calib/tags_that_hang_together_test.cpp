#include "observations/tags_that_hang_together.h"

#include <gtest/gtest.h>

namespace apriltrack {
namespace {

using Membership = std::vector<bool>;

/// Tags 0, 1 and 2 in a chain, and 5 with 6 apart from them.
const std::vector<TagAtMoment> kSeenInChain = {{0, 0}, {1, 0}, {0, 1}, {1, 1}, {1, 2}, {2, 2},
                                               {1, 3}, {2, 3}, {5, 4}, {6, 4}, {5, 5}, {6, 5}};

TEST(TagsThatHangTogether, AreThePartWithTheWantedTag) {
  const HangingTogether chain = tags_that_hang_together(kSeenInChain, 2);
  EXPECT_EQ(chain.held_tag, 2);
  EXPECT_EQ(chain.is_in,
            (Membership{true, true, true, true, true, true, true, true, false, false, false, false}));
  const HangingTogether pair = tags_that_hang_together(kSeenInChain, 6);
  EXPECT_EQ(pair.held_tag, 6);
  EXPECT_EQ(pair.is_in,
            (Membership{false, false, false, false, false, false, false, false, true, true, true, true}));
}

TEST(TagsThatHangTogether, HoldTheTagThatIsSeenMostWhereTheWantedOneIsNotThere) {
  const HangingTogether together = tags_that_hang_together(kSeenInChain, 9);
  EXPECT_EQ(together.held_tag, 1);
  EXPECT_TRUE(together.is_in[0]);
  EXPECT_FALSE(together.is_in[8]);
}

TEST(TagsThatHangTogether, AreSeenTwiceAndWithOthers) {
  // Tag 3 once; moment 6 shows tag 0 alone, moment 7 but for tag 3.
  std::vector<TagAtMoment> seen = kSeenInChain;
  seen.insert(seen.end(), {{0, 6}, {3, 7}, {0, 7}});
  const HangingTogether together = tags_that_hang_together(seen, 0);
  EXPECT_EQ(Membership(together.is_in.end() - 3, together.is_in.end()), (Membership{false, false, false}));
  EXPECT_TRUE(together.is_in[0]);
  EXPECT_EQ(tags_that_hang_together({{0, 0}, {1, 1}}, 0).held_tag, -1);
  EXPECT_EQ(tags_that_hang_together({}, 0).held_tag, -1);
}

}  // namespace
}  // namespace apriltrack
