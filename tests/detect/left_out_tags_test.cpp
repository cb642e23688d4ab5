// What a run read and left out is counted by reason, and each tag is named once.

#include "apriltrack/detect/left_out_tags.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

namespace apriltrack {
namespace {

using ::testing::HasSubstr;

LeftOutTag left_out(int id, LeftOutReason reason) {
  return {{{"tag36h11", id}, {}, 0, 90.0}, reason};
}

TEST(LeftOutTags, OfNoneSayNothing) {
  const LeftOutTags none;
  EXPECT_TRUE(none.is_empty());
  EXPECT_EQ(none.message(), "");
}

TEST(LeftOutTags, CountReadingsAndNameTagsOnce) {
  LeftOutTags first, second;
  first.add(std::vector<LeftOutTag>{left_out(8, LeftOutReason::kEdgesNotFitted)});
  second.add(std::vector<LeftOutTag>{left_out(8, LeftOutReason::kEdgesNotFitted),
                                     left_out(3, LeftOutReason::kMayBeChance)});
  first.add(second);
  EXPECT_EQ(first.by_reason().at(LeftOutReason::kEdgesNotFitted).count, 2U);
  EXPECT_EQ(first.by_reason().at(LeftOutReason::kEdgesNotFitted).tags.size(), 1U);
  EXPECT_THAT(first.message(), HasSubstr("2 readings of tags (tag36h11/8) were left out because the edges"));
  EXPECT_THAT(first.message(), HasSubstr("1 reading of a tag (tag36h11/3) was left out because they may be"));
}

TEST(LeftOutTags, NameEightAtMost) {
  LeftOutTags many;
  for (int id = 0; id < 11; ++id)
    many.add(std::vector<LeftOutTag>{left_out(id, LeftOutReason::kEdgesNotFitted)});
  EXPECT_THAT(many.message(), HasSubstr("tag36h11/7 and 3 more)"));
}

}  // namespace
}  // namespace apriltrack
