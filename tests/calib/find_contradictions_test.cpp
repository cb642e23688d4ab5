// Which tags and pairs contradict their frames more than chance does, from counts that a coin would give.
#include <gmock/gmock.h>

#include "model/contradictions.h"

namespace apriltrack {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

/// Frames that show three tags each; the first of them is far off in some.
struct Filmed {
  Observations observations;
  Part part;
  std::vector<std::size_t> gross;

  void add(int num_frames, int num_gross, std::initializer_list<int> tags) {
    for (int i = 0; i < num_frames; ++i) {
      for (const int tag : tags) {
        const std::size_t v = observations.views.size();
        observations.views.push_back({tag, next_frame_, 0, {}, Matrix8d::Identity(), Vector8d::Zero()});
        part.views.push_back(v);
        if (i < num_gross && tag == *tags.begin()) gross.push_back(v);
      }
      ++next_frame_;
    }
  }
  Contradictions found() const { return find_contradictions(observations, part, gross); }

 private:
  int next_frame_ = 0;
};

TEST(FindContradictions, TakesForChanceWhatHappensOnceInAThousandRooms) {
  // Elsewhere 5 % of the frames contradict: of 11, four or more do with probability 1.5e-3.
  Filmed filmed;
  filmed.add(11, 4, {0, 1, 2});
  filmed.add(400, 20, {3, 4, 5});
  EXPECT_THAT(filmed.found().tags, IsEmpty());
}

TEST(FindContradictions, NamesTheTagThatIsFarOffInMostFrames) {
  // Eight of 11 with probability 5.7e-9.
  Filmed filmed;
  filmed.add(11, 8, {0, 1, 2});
  filmed.add(400, 20, {3, 4, 5});
  EXPECT_THAT(filmed.found().tags, ElementsAre(0));
  EXPECT_THAT(filmed.found().links, Contains(std::pair(0, 1)));
}

TEST(FindContradictions, CountsAFrameThatLeavesNoTwoThatFitAgainstAll) {
  Filmed filmed;
  filmed.add(12, 10, {0, 1});
  filmed.add(400, 4, {3, 4, 5});
  EXPECT_THAT(filmed.found().tags, ElementsAre(0, 1));
}

}  // namespace
}  // namespace apriltrack
