#include <gtest/gtest.h>

#include <vector>

#include "contrast_memory.h"
#include "hidden_tags.h"
#include "plain_world.h"

namespace apriltrack {
namespace {

TagEvidence seen_tag(int index, double correlation, double contrast = 0.5) {
  return {.tag_index = index, .correlation = correlation, .contrast = contrast};
}

/// The correlation that is left of 0.97.
double left_of_correlation(const ContrastMemory& memory, int index, double contrast) {
  std::vector<TagEvidence> tags = {seen_tag(index, 0.97, contrast)};
  memory.doubt(tags);
  EXPECT_EQ(tags[0].contrast, contrast);
  return tags[0].correlation;
}

TEST(ContrastMemory, DoubtsAFactorOfOnePointFourEitherWay) {
  ContrastMemory memory;
  memory.remember({seen_tag(3, 0.97, 0.2), seen_tag(5, 0.97, 0.8)});
  for (const auto& [index, contrast] : {std::pair{3, 0.2}, std::pair{5, 0.8}}) {
    EXPECT_EQ(left_of_correlation(memory, index, contrast), 0.97);
    EXPECT_EQ(left_of_correlation(memory, index, 1.399 * contrast), 0.97);
    EXPECT_EQ(left_of_correlation(memory, index, 1.401 * contrast), 0.0);
    EXPECT_EQ(left_of_correlation(memory, index, contrast / 1.399), 0.97);
    EXPECT_EQ(left_of_correlation(memory, index, contrast / 1.401), 0.0);
    EXPECT_EQ(left_of_correlation(memory, index, -contrast), 0.0);
  }
  EXPECT_EQ(left_of_correlation(memory, 4, 100.0), 0.97);  // never seen: nothing to doubt it by
}

TEST(ContrastMemory, HasItFromTheLatestFrameThatShowedTheTagWell) {
  ContrastMemory memory;
  memory.remember({seen_tag(0, 0.899, 0.2)});
  EXPECT_EQ(left_of_correlation(memory, 0, 0.8), 0.97);  // not well enough
  memory.remember({seen_tag(0, 0.9, 0.2)});
  EXPECT_EQ(left_of_correlation(memory, 0, 0.8), 0.0);
  memory.remember({seen_tag(0, 0.95, 0.8)});
  EXPECT_EQ(left_of_correlation(memory, 0, 0.8), 0.97);
  EXPECT_EQ(left_of_correlation(memory, 0, 0.2), 0.0);
  memory.remember({seen_tag(0, 0.5, 0.2), seen_tag(1, 0.95, 0.2)});
  EXPECT_EQ(left_of_correlation(memory, 0, 0.8), 0.97);
}

TEST(ContrastMemory, DoubtsEachTagByItsOwn) {
  ContrastMemory memory;
  memory.remember({seen_tag(0, 0.95, 0.2), seen_tag(1, 0.95, 0.8)});
  std::vector<TagEvidence> tags = {seen_tag(1, 0.9, 0.2), seen_tag(0, 0.9, 0.2), seen_tag(7, 0.3, 0.2)};
  memory.doubt(tags);
  EXPECT_EQ(tags[0].correlation, 0.0);
  EXPECT_EQ(tags[1].correlation, 0.9);
  EXPECT_EQ(tags[2].correlation, 0.3);
}

/// Three tags of a map, with ids that are no indices.
class TagsBehindThings : public ::testing::Test {
 protected:
  TagsBehindThings() : world_(camera(), test::tags_at_origin({12, 10, 11}), TrackMode::kEgo, 64, 64) {}

  static Camera camera() { return {.model = CameraModel({60.0, 60.0, 31.5, 31.5}, NoDistortion{})}; }
  /// Which are, by index, in a frame that reads these.
  std::vector<bool> hidden(const std::vector<int>& indices_read = {}) {
    std::vector<TagObservation> observations;
    for (const int index : indices_read) observations.emplace_back().tag_index = index;
    hidden_.mark(world_, observations);
    std::vector<bool> result;
    for (const PhotometricTag& tag : world_.tags) result.push_back(tag.is_hidden);
    return result;
  }
  /// Tag 0 agrees, tag 1 is not seen where it should be, tag 2 is out of the image.
  void learn_that_tag_1_is_hidden(int num_frames = HiddenTags::kMinFramesUnseen) {
    for (int i = 0; i < num_frames; ++i)
      hidden_.learn({seen_tag(0, 0.97), seen_tag(1, 0.849)}, {{0}, {}}, true);
  }

  PhotometricWorld world_;
  HiddenTags hidden_;
};

using Flags = std::vector<bool>;

TEST_F(TagsBehindThings, TakeNoPartUntilTheyAreRead) {
  EXPECT_EQ(hidden(), Flags({false, false, false}));
  learn_that_tag_1_is_hidden();
  EXPECT_EQ(hidden(), Flags({false, true, false}));
  EXPECT_EQ(hidden({0, 2}), Flags({false, true, false}));
  EXPECT_EQ(hidden({1}), Flags({false, false, false}));  // in the frame that reads it
  EXPECT_EQ(hidden(), Flags({false, true, false}));      // a false reading is no proof
}

TEST_F(TagsBehindThings, AreKnownOnlyFromThreeSurePoses) {
  const std::vector<TagEvidence> tags = {seen_tag(0, 0.97), seen_tag(1, 0.3)};
  for (int i = 0; i < 10; ++i) hidden_.learn(tags, {{0}, {}}, false);
  EXPECT_EQ(hidden(), Flags({false, false, false}));
  learn_that_tag_1_is_hidden(2);
  EXPECT_EQ(hidden(), Flags({false, false, false}));
  EXPECT_TRUE(hidden_.is_empty());
  learn_that_tag_1_is_hidden(1);
  EXPECT_EQ(hidden(), Flags({false, true, false}));
  EXPECT_FALSE(hidden_.is_empty());
}

TEST_F(TagsBehindThings, AreCountedAnewAfterTheyWereSeen) {
  learn_that_tag_1_is_hidden(2);
  hidden_.learn({seen_tag(1, 0.9)}, {{}, {}}, true);
  learn_that_tag_1_is_hidden(2);
  EXPECT_EQ(hidden(), Flags({false, false, false}));
}

TEST_F(TagsBehindThings, ComeBackWhereTheyAreExplainedOrAgree) {
  learn_that_tag_1_is_hidden();
  hidden_.learn({seen_tag(1, 0.849)}, {{}, {}}, false);
  EXPECT_EQ(hidden(), Flags({false, true, false}));
  hidden_.learn({seen_tag(1, 0.85)}, {{}, {}}, false);  // this much any pose may tell
  EXPECT_EQ(hidden(), Flags({false, false, false}));
  learn_that_tag_1_is_hidden();
  hidden_.learn({seen_tag(1, 0.3)}, {{1}, {}}, true);
  EXPECT_EQ(hidden(), Flags({false, false, false}));
}

TEST_F(TagsBehindThings, StayHiddenWhileTheyAreOutOfTheImage) {
  learn_that_tag_1_is_hidden();
  hidden_.learn({seen_tag(0, 0.97), seen_tag(2, 0.97)}, {{0}, {}}, true);
  EXPECT_EQ(hidden(), Flags({false, true, false}));
}

}  // namespace
}  // namespace apriltrack
