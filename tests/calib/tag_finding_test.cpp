// When what was found of a tag explains its views, and the words for a tag of which another may be at fault.
#include "tag_finding.h"

#include <gmock/gmock.h>

#include "tag_fault_words.h"

namespace apriltrack {
namespace {

using ::testing::HasSubstr;
using Kind = TagFinding::Kind;

bool is_complete(Kind kind, double misfit_before, double misfit_after) {
  return TagFinding{.kind = kind, .words = "", .misfit_before = misfit_before, .misfit_after = misfit_after}
      .is_complete();
}

TEST(TagFinding, IsCompleteWhereNothingIsLeft) {
  for (const Kind kind : {Kind::kSize, Kind::kMoved, Kind::kTwoPlaces, Kind::kNotFlat})
    EXPECT_TRUE(is_complete(kind, 5.0, 1.2));
  for (const Kind kind : {Kind::kSize, Kind::kMoved, Kind::kTwoPlaces, Kind::kNotFlat})
    EXPECT_FALSE(is_complete(kind, 5.0, 2.0));
}

// A map without the tag that joined it errs: of a large misfit some is left by what explains it.
TEST(TagFinding, IsCompleteWhereHardlyAnythingOfMuchIsLeft) {
  EXPECT_TRUE(is_complete(Kind::kMoved, 50.0, 4.0));
  EXPECT_FALSE(is_complete(Kind::kMoved, 50.0, 6.0));
  EXPECT_TRUE(is_complete(Kind::kTwoPlaces, 50.0, 4.0));
  EXPECT_TRUE(is_complete(Kind::kSize, 20.0, 2.5));
  EXPECT_FALSE(is_complete(Kind::kSize, 20.0, 4.0));
  EXPECT_FALSE(is_complete(Kind::kNotFlat, 50.0, 4.0));
}

TEST(TagFinding, IsCompleteOfATagWithoutAPlace) {
  EXPECT_TRUE(is_complete(Kind::kLoose, 9.0, 9.0));
}

TEST(TagFaultWords, TellOnceThatAnotherMayBeAtFault) {
  const std::string once = words_of_rival("A was moved");
  EXPECT_EQ(once, "Perhaps A was moved. Or another tag is at fault: the views do not tell which");
  EXPECT_EQ(words_of_rival(once), once);
}

TEST(TagFaultWords, NameTheOneOrTheSeveralThatMayBe) {
  const std::vector<TagKey> four{{"tag36h11", 4}}, board{{"tag36h11", 4}, {"tag36h11", 5}};
  EXPECT_THAT(words_of_rivals_in_map("A was moved", {four}),
              HasSubstr("Perhaps A was moved. Or tag36h11/4, which alone joins its two places"));
  EXPECT_THAT(words_of_rivals_in_map("A was moved", {board}),
              HasSubstr("Or the board (tag36h11/4, tag36h11/5), which alone joins its two places"));
  EXPECT_THAT(
      words_of_rivals_instead("A was moved", {{{"tag36h11", 6}}, board}),
      HasSubstr("Or one of tag36h11/6, the board (tag36h11/4, tag36h11/5), each of which alone joins"));
  EXPECT_THAT(words_of_joint("tag36h11/4", four, "tag36h11/7"),
              HasSubstr("tag36h11/4 alone joins the two places at which tag36h11/7 is seen: it may be what"));
  EXPECT_THAT(words_of_joint("tag36h11/4", board, "tag36h11/7"),
              HasSubstr("tag36h11/4 (of the board tag36h11/4, tag36h11/5) alone joins"));
}

}  // namespace
}  // namespace apriltrack
