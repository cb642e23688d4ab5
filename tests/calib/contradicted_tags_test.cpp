// Tags of which more views were rejected than kept, from exact corners: which go, and that the others stay
// right.
#include "hypotheses/contradicted_tags.h"

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "adjusted_world.h"

namespace apriltrack {
namespace {

using test::AdjustedWorld;
using test::SyntheticWorld;

constexpr int kSound = 3, kRejected = 5;  // neighbours on a wall

int id_of(const Detection& detection) {
  return detection.tag.id;
}

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

TEST(ContradictedTags, SpareTheTagThatWasSeenBesideThem) {
  // Two tags are seen together alone in most frames; the views of one were rejected there, and with it the
  // frames.
  const SyntheticWorld world = test::make_room(6, 120, test::equidistant_camera());
  std::vector<FrameDetections> frames = test::exact_detections(world);
  int frames_of_two = 0, others = 0;
  for (FrameDetections& frame : frames) {
    const auto shows = [&](int id) { return std::ranges::count(frame.detections, id, id_of) > 0; };
    if (!shows(kSound) || !shows(kRejected)) {
      const bool is_sound_kept = others++ % 3 == 0;
      std::erase_if(frame.detections, [&](const Detection& d) {
        return id_of(d) == kRejected || (id_of(d) == kSound && !is_sound_kept);
      });
      continue;
    }
    if (frames_of_two++ % 4 == 3) continue;
    std::erase_if(frame.detections,
                  [](const Detection& d) { return id_of(d) != kSound && id_of(d) != kRejected; });
  }
  ASSERT_GT(frames_of_two, 12);
  AdjustedWorld one(world, frames);
  const int sound = one.index_of(kSound), rejected = one.index_of(kRejected);
  std::map<int, std::set<int>> tags_of_frame;
  for (const std::size_t v : one.offered.views)
    tags_of_frame[one.observations.views[v].frame].insert(one.observations.views[v].tag);
  std::erase_if(one.solved.part.views, [&](std::size_t v) {
    return tags_of_frame.at(one.observations.views[v].frame) == std::set{sound, rejected};
  });
  EXPECT_EQ(leave_out_contradicted(one.task(), one.offered, one.solved), std::vector{rejected});
  EXPECT_TRUE(std::ranges::binary_search(one.solved.part.tags, sound));
}

}  // namespace
}  // namespace apriltrack
