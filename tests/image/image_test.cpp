#include "apriltrack/image/image.h"

#include <gtest/gtest.h>

#include <vector>

namespace apriltrack {
namespace {

/// 3 x 2 pixels in rows of five: columns 3 and 4 belong to somebody else.
class PaddedView : public testing::Test {
 protected:
  std::vector<std::uint8_t> memory_ = {1, 2, 3, 90, 91, 4, 5, 6, 92, 93};
  ImageView<std::uint8_t> view_{memory_.data(), 3, 2, 5};
};

TEST_F(PaddedView, StepsFromRowToRowByItsStride) {
  EXPECT_EQ(view_(0, 0), 1);
  EXPECT_EQ(view_(2, 0), 3);
  EXPECT_EQ(view_(0, 1), 4);
  EXPECT_EQ(view_(2, 1), 6);
  EXPECT_EQ(view_.row(1), memory_.data() + 5);
}

TEST_F(PaddedView, WritesThroughToItsMemory) {
  view_(1, 1) = 77;
  EXPECT_EQ(memory_[6], 77);
}

TEST_F(PaddedView, ServesAsAViewOfConstantPixelsWithoutACopy) {
  const GrayView constant = view_;
  EXPECT_EQ(constant.data(), memory_.data());
  EXPECT_EQ(constant.stride(), 5);
  EXPECT_EQ(constant(2, 1), 6);
}

TEST_F(PaddedView, ContainsItsPixelsAndNoOthers) {
  EXPECT_TRUE(view_.contains(0, 0));
  EXPECT_TRUE(view_.contains(2, 1));
  for (const auto& [x, y] : {std::pair(-1, 0), {0, -1}, {3, 0}, {0, 2}}) EXPECT_FALSE(view_.contains(x, y));
}

TEST(ImageView, ADefaultOneIsEmpty) {
  EXPECT_TRUE(GrayView().is_empty());
  EXPECT_FALSE(GrayView().contains(0, 0));
}

TEST(Image, HoldsItsPixelsRowByRow) {
  Image<float> image(4, 3, 0.5F);
  EXPECT_EQ(image.width(), 4);
  EXPECT_EQ(image.height(), 3);
  EXPECT_EQ(image(3, 2), 0.5F);
  image(1, 2) = 7.0F;
  EXPECT_EQ(image.row(2)[1], 7.0F);
  EXPECT_EQ(image.row(0) + 9, &image(1, 2));
  EXPECT_TRUE(Image<float>().is_empty());
}

TEST(Image, CopiesAreIndependent) {
  GrayImage image(2, 2, 9);
  GrayImage copy = image;
  copy(0, 0) = 1;
  EXPECT_EQ(image(0, 0), 9);
}

}  // namespace
}  // namespace apriltrack
