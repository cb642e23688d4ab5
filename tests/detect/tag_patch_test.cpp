#include "apriltrack/detect/tag_patch.h"

#include <gtest/gtest.h>

#include <limits>

#include "apriltrack/detect/detection.h"

namespace apriltrack {
namespace {

GrayImage numbered(int width, int height) {
  GrayImage image(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) image(x, y) = static_cast<std::uint8_t>(x + 7 * y);
  }
  return image;
}

/// A square of 40 px about (60, 50).
Detection square() {
  Detection detection;
  detection.tag = {"tag36h11", 3};
  detection.corners_px = {Eigen::Vector2d(40, 70), {80, 70}, {80, 30}, {40, 30}};
  return detection;
}

TEST(TagPatch, HoldsTheWhiteBorderAndAMarginAboutIt) {
  const GrayImage image = numbered(120, 100);
  const auto patch = cut_patch(image.view(), square());
  ASSERT_TRUE(patch.has_value());
  EXPECT_EQ(patch->tag, (TagKey{"tag36h11", 3}));
  // Ten cells where the square has eight: 50 px, and 4 px more on each side.
  EXPECT_EQ(patch->x, 31);
  EXPECT_EQ(patch->y, 21);
  EXPECT_EQ(patch->pixels.width(), 59);
  EXPECT_EQ(patch->pixels.height(), 59);
  for (int y = 0; y < 59; ++y) {
    for (int x = 0; x < 59; ++x) ASSERT_EQ(patch->pixels(x, y), image(x + 31, y + 21));
  }
}

TEST(TagPatch, EndsWhereTheImageEnds) {
  const GrayImage image = numbered(70, 60);
  const auto patch = cut_patch(image.view(), square());
  ASSERT_TRUE(patch.has_value());
  EXPECT_EQ(patch->x + patch->pixels.width(), 70);
  EXPECT_EQ(patch->y + patch->pixels.height(), 60);
}

TEST(TagPatch, IsNoneOfWhatIsNotInTheImage) {
  const GrayImage image = numbered(120, 100);
  Detection outside = square();
  for (Eigen::Vector2d& corner : outside.corners_px) corner.x() += 500.0;
  EXPECT_FALSE(cut_patch(image.view(), outside).has_value());
  Detection broken = square();
  broken.corners_px[2].y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(cut_patch(image.view(), broken).has_value());
  Detection strange = square();
  strange.tag.family = "tag99h1";
  EXPECT_FALSE(cut_patch(image.view(), strange).has_value());
}

}  // namespace
}  // namespace apriltrack
