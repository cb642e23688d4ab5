// How much work it is to try other families: so many small pictures, whatever the recording.

#include <gtest/gtest.h>

#include "other_families.h"

namespace apriltrack {
namespace {

TEST(FamilySample, LooksMostlyAtFramesThatShowNoTagAskedFor) {
  const std::vector<Detection> read = {{{"tag36h11", 3}, {}, 0, 90.0}};
  const std::vector<Detection> corrected = {{{"tag36h11", 3}, {}, 1, 90.0}};  // may be another's tag
  FamilySample explained, mixed;
  for (int i = 0; i < 100; ++i) {
    const GrayImage frame(1920, 1080);
    explained.offer(frame.view(), read);
    const bool is_tagless = i < 40;
    mixed.offer(frame.view(), is_tagless ? std::span<const Detection>() : read);
    if (i >= 90) mixed.offer(frame.view(), corrected);
  }
  EXPECT_LE(explained.images().size(), FamilySample::kMostExplained);
  EXPECT_GE(explained.images().size(), 1U);
  EXPECT_GE(mixed.images().size(), 5U);
  EXPECT_LE(mixed.images().size(), FamilySample::kMostExplained + FamilySample::kMostUnexplained);
  for (const GrayImage& image : mixed.images()) EXPECT_EQ(image.width(), 960);
}

}  // namespace
}  // namespace apriltrack
