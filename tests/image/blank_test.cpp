// An image without content is told from a dim one, whatever its brightness and the sensor's noise.

#include "apriltrack/image/blank.h"

#include <gtest/gtest.h>

namespace apriltrack {
namespace {

GrayImage uniform(std::uint8_t level) {
  GrayImage image(200, 120);
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x) image(x, y) = level;
  return image;
}

TEST(Blank, OneBrightnessIsBlankWhateverItIs) {
  for (const int level : {0, 90, 255})
    EXPECT_TRUE(is_blank(uniform(static_cast<std::uint8_t>(level)).view())) << level;
}

TEST(Blank, NoiseOfPixelsIsNoContent) {
  GrayImage image = uniform(0);
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x) image(x, y) = static_cast<std::uint8_t>(20 + 12 * ((x + y) % 2));
  EXPECT_TRUE(is_blank(image.view()));
}

TEST(Blank, OneBlockThatIsBrighterIsContent) {
  GrayImage image = uniform(20);
  for (int y = 32; y < 48; ++y)
    for (int x = 64; x < 80; ++x) image(x, y) = 25;
  EXPECT_FALSE(is_blank(image.view())) << "5 grey levels in one block of 16 x 16";
}

}  // namespace
}  // namespace apriltrack
