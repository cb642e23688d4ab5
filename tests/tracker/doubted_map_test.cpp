#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "hidden_tags.h"

namespace apriltrack {
namespace {

constexpr double kManyPixels = 1e4;

TagEvidence evidence_of_tag(int index, double correlation, double area_px = kManyPixels) {
  return {.tag_index = index,
          .num_pixels = static_cast<int>(area_px),
          .area_px = area_px,
          .correlation = correlation};
}

/// Of forty tags the first two are there.
class DoubtedMap : public ::testing::Test {
 protected:
  DoubtedMap() : world_(camera(), map(), TrackMode::kEgo, 64, 64) {}

  static constexpr int kNumTags = 40;

  static Camera camera() { return {.model = CameraModel({60.0, 60.0, 31.5, 31.5}, NoDistortion{})}; }
  static TagMap map() {
    TagMap map;
    for (int id = 0; id < kNumTags; ++id) {
      MapTag tag;
      tag.key = {"tag36h11", id};
      tag.size_m = 0.2;
      map.tags.push_back(tag);
    }
    return map;
  }

  /// Sure frames that show the first two, and miss `num_missed` others.
  void see_two_and_miss(int num_missed, int num_frames = HiddenTags::kMinFramesUnseen) {
    std::vector<TagEvidence> tags = {evidence_of_tag(0, 0.97), evidence_of_tag(1, 0.97)};
    for (int i = 0; i < num_missed; ++i) tags.push_back(evidence_of_tag(2 + i, 0.1));
    for (int i = 0; i < num_frames; ++i) hidden_.learn(tags, {{0, 1}, {}}, true);
  }
  std::ptrdiff_t num_hidden() const { return std::ranges::count_if(world_.tags, &PhotometricTag::is_hidden); }
  void mark(const std::vector<int>& indices_read = {}) {
    std::vector<TagObservation> observations;
    for (const int index : indices_read) observations.emplace_back().tag_index = index;
    hidden_.mark(world_, observations);
  }

  PhotometricWorld world_;
  HiddenTags hidden_;
};

TEST_F(DoubtedMap, HidesTagsBeforeTheyAreMissed) {
  see_two_and_miss(9);
  mark();
  EXPECT_EQ(num_hidden(), 9);
  see_two_and_miss(10);
  mark();
  EXPECT_EQ(num_hidden(), kNumTags - 2);
  EXPECT_FALSE(world_.tag_at(0).is_hidden);
  hidden_.unmark(world_);
  EXPECT_EQ(num_hidden(), 0);
  EXPECT_EQ(std::ranges::count_if(world_.tags, &PhotometricTag::is_passed_over), 0);
}

TEST_F(DoubtedMap, LooksForATagThatWasMissedInOneOfEightFramesAndForOthersInAll) {
  see_two_and_miss(10);
  std::vector<int> times_looked_for(kNumTags);
  for (int frame = 0; frame < 8; ++frame) {
    mark();
    for (int i = 0; i < kNumTags; ++i) {
      if (world_.tag_at(i).is_hidden && !world_.tag_at(i).is_passed_over)
        ++times_looked_for[static_cast<std::size_t>(i)];
    }
    see_two_and_miss(0, 1);
  }
  for (int i = 2; i < kNumTags; ++i)
    EXPECT_EQ(times_looked_for[static_cast<std::size_t>(i)], i < 12 ? 1 : 8) << i;
}

TEST_F(DoubtedMap, BelievesATagThatIsReadOrWellSeen) {
  see_two_and_miss(10);
  mark({20});
  EXPECT_FALSE(world_.tag_at(20).is_hidden);
  hidden_.learn({evidence_of_tag(21, 0.9, 100.0)}, {}, false);  // a sliver, that fits by chance
  hidden_.learn({evidence_of_tag(22, 0.9)}, {}, false);
  hidden_.learn({evidence_of_tag(23, 0.2)}, {{23}, {}}, false);
  mark();
  EXPECT_TRUE(world_.tag_at(20).is_hidden);
  EXPECT_TRUE(world_.tag_at(21).is_hidden);
  EXPECT_FALSE(world_.tag_at(22).is_hidden);
  EXPECT_FALSE(world_.tag_at(23).is_hidden);
}

TEST_F(DoubtedMap, ExpectsNothingOfWhatItMissedEvenWhereNothingElseConvinces) {
  EXPECT_FALSE(hidden_.has_hopeful());
  see_two_and_miss(10);
  EXPECT_TRUE(hidden_.has_hopeful());  // the next room
  hidden_.mark_doubted(world_, {});
  EXPECT_EQ(num_hidden(), 10);
  const std::vector<TagEvidence> before_a_hand = {evidence_of_tag(1, 0.1)};
  for (int i = 0; i < HiddenTags::kMinFramesUnseen; ++i) hidden_.learn(before_a_hand, {{0}, {}}, true);
  hidden_.mark_doubted(world_, {});
  EXPECT_FALSE(world_.tag_at(1).is_hidden);
  mark();
  EXPECT_TRUE(world_.tag_at(1).is_hidden);
}

}  // namespace
}  // namespace apriltrack
