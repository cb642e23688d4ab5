// A few small copies stand for a stream of any length.

#include "apriltrack/image/even_sample.h"

#include <gtest/gtest.h>

namespace apriltrack {
namespace {

TEST(EvenSample, OfLargePhotosKeepsFewSmallCopies) {
  EvenSample sample(4);
  for (int i = 0; i < 12; ++i) {
    GrayImage photo(4000, 3000);
    photo(0, 0) = photo(1, 0) = photo(0, 1) = photo(1, 1) = 16;
    photo(2, 0) = static_cast<std::uint8_t>(16 * i);
    sample.offer(photo.view());
  }
  ASSERT_LE(sample.images().size(), 4U);
  ASSERT_GE(sample.images().size(), 2U);
  for (const GrayImage& image : sample.images()) {
    EXPECT_EQ(image.width(), 1000);
    EXPECT_EQ(image.height(), 750);
  }
}

TEST(EvenSample, KeepsOrdinaryFramesAsTheyAre) {
  EvenSample sample(20);
  sample.offer(GrayImage(1920, 1080).view());
  EXPECT_EQ(sample.images().at(0).width(), 1920);
}

TEST(EvenSample, IsSpreadEvenly) {
  EvenSample sample(4);
  for (int i = 0; i < 16; ++i) {
    GrayImage frame(1, 1);
    frame(0, 0) = static_cast<std::uint8_t>(i);
    sample.offer(frame.view());
  }
  std::vector<int> kept;
  for (const GrayImage& image : sample.images()) kept.push_back(image(0, 0));
  EXPECT_EQ(kept, (std::vector<int>{0, 4, 8, 12}));
}

}  // namespace
}  // namespace apriltrack
