#include "picture_shift.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>

#include "apriltrack/base/random.h"

namespace apriltrack {
namespace {

constexpr double kCommonShare = 0.4;

Image<float> noisy_picture(RandomStream& random, int width, int height) {
  Image<float> picture(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) picture(x, y) = static_cast<float>(random.uniform());
  }
  return picture;
}

/// The part of a large picture whose first pixel is (x0, y0).
Image<float> cut(const Image<float>& large, int x0, int y0, int width, int height, float gain = 1.0F,
                 float offset = 0.0F) {
  Image<float> picture(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) picture(x, y) = gain * large(x0 + x, y0 + y) + offset;
  }
  return picture;
}

/// Pearson's, of all pixels that both have, one after the other.
double plain_correlation(const Image<float>& before, const Image<float>& now, int dx, int dy) {
  double n = 0.0, a = 0.0, b = 0.0, aa = 0.0, bb = 0.0, ab = 0.0;
  for (int y = 0; y < now.height(); ++y) {
    for (int x = 0; x < now.width(); ++x) {
      if (!before.view().contains(x + dx, y + dy)) continue;
      const auto here = static_cast<double>(now(x, y)), there = static_cast<double>(before(x + dx, y + dy));
      n += 1.0;
      a += here;
      b += there;
      aa += here * here;
      bb += there * there;
      ab += here * there;
    }
  }
  if (n < kCommonShare * now.width() * now.height()) return -2.0;
  return (ab - a * b / n) / std::sqrt((aa - a * a / n) * (bb - b * b / n));
}

TEST(PictureShift, CorrelatesBestOfAll) {
  RandomStream random(1);
  PictureShifts shifts(kCommonShare);
  for (int i = 0; i < 10; ++i) {
    // Unlike each other: nothing but the numbers decides.
    const int width = 7 + i, height = 16 - i;
    const Image<float> before = noisy_picture(random, width, height),
                       now = noisy_picture(random, width, height);
    PictureShift expected;
    for (int dy = -height; dy <= height; ++dy) {
      for (int dx = -width; dx <= width; ++dx) {
        const double correlation = plain_correlation(before, now, dx, dy);
        if (correlation > expected.correlation) expected = {dx, dy, correlation};
      }
    }
    const PictureShift found = shifts.best(before, now);
    EXPECT_EQ(found.dx, expected.dx) << i;
    EXPECT_EQ(found.dy, expected.dy) << i;
    EXPECT_NEAR(found.correlation, expected.correlation, 1e-5) << i;  // products are summed in float
  }
}

TEST(PictureShift, LeadsFromNowToBeforeWhateverTheLight) {
  RandomStream random(2);
  const Image<float> large = noisy_picture(random, 80, 70);
  PictureShifts shifts(kCommonShare);
  const Image<float> before = cut(large, 20, 20, 40, 30);
  for (const auto& [dx, dy] : {std::pair(0, 0), std::pair(9, -4), std::pair(-17, 3), std::pair(2, 15)}) {
    const PictureShift found = shifts.best(before, cut(large, 20 + dx, 20 + dy, 40, 30, 0.3F, 0.5F));
    EXPECT_EQ(found.dx, dx);
    EXPECT_EQ(found.dy, dy);
    EXPECT_NEAR(found.correlation, 1.0, 1e-5);
  }
}

TEST(PictureShift, LeavesEnoughInCommon) {
  RandomStream random(3);
  const Image<float> large = noisy_picture(random, 100, 30);
  const Image<float> before = cut(large, 0, 0, 40, 30), now = cut(large, 25, 0, 40, 30);
  EXPECT_EQ(PictureShifts(0.37).best(before, now).dx, 25);  // 15 columns of 40
  EXPECT_LT(PictureShifts(0.38).best(before, now).correlation, 0.5);
}

TEST(PictureShift, OfPlainPicturesIsNone) {
  RandomStream random(4);
  const Image<float> plain(20, 20, 0.5F);
  PictureShifts shifts(kCommonShare);
  EXPECT_EQ(shifts.best(plain, plain).correlation, -1.0);
  EXPECT_EQ(shifts.best(noisy_picture(random, 20, 20), plain).correlation, -1.0);
}

TEST(PictureShift, TakesWhatIsUnseenForTheMean) {
  RandomStream random(5);
  const Image<float> large = noisy_picture(random, 60, 50);
  Image<float> before = cut(large, 10, 10, 30, 20), now = cut(large, 13, 8, 30, 20);
  // Beyond a lens: corners.
  for (Image<float>* picture : {&before, &now}) {
    for (int k = 0; k < 5; ++k) {
      for (int x = 0; x < 5 - k; ++x) (*picture)(x, k) = std::numeric_limits<float>::quiet_NaN();
    }
  }
  const PictureShift found = PictureShifts(kCommonShare).best(before, now);
  EXPECT_EQ(found.dx, 3);
  EXPECT_EQ(found.dy, -2);
  EXPECT_GT(found.correlation, 0.9);
}

}  // namespace
}  // namespace apriltrack
