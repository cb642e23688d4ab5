#include "image_names.h"

#include <gmock/gmock.h>

#include <algorithm>

namespace apriltrack::test {
namespace {

TEST(NaturalLess, OrdersByNumberAndElseByText) {
  std::vector<std::string> names = {"b2", "a10", "a9", "a", "a010", "10", "9", "a9b", "a9a10", "a9a9", ""};
  std::ranges::sort(names, natural_less);
  EXPECT_THAT(names,
              ::testing::ElementsAre("", "9", "10", "a", "a9", "a9a9", "a9a10", "a9b", "a010", "a10", "b2"));
}

TEST(NaturalLess, TakesNumbersOfAnyLength) {
  EXPECT_TRUE(natural_less("99999999999999999999999", "100000000000000000000000"));
  EXPECT_FALSE(natural_less("100000000000000000000000", "99999999999999999999999"));
}

TEST(TimeInName, IsThereOnlyForDigitsAndSeconds) {
  EXPECT_EQ(time_in_name("x/1403636579763555584.png")->ns, 1403636579763555584);
  EXPECT_EQ(time_in_name("0007.jpg")->ns, 7);
  for (const char* name :
       {"a.png", "-5.png", "-1.5.png", "1.5e3.png", "1e3.png", ".png", "99999999999999999999.png"}) {
    EXPECT_FALSE(time_in_name(name)) << name;
  }
}

/// To the nanosecond, which no double of such times holds.
TEST(TimeInName, OfSecondsIsExact) {
  EXPECT_EQ(time_in_name("rgb/1305031102.175304.png")->ns, 1305031102175304000);
  EXPECT_EQ(time_in_name("1305031102.1753.png")->ns, 1305031102175300000);
  EXPECT_EQ(time_in_name("1700000000.123456789.jpg")->ns, 1700000000123456789);
  EXPECT_EQ(time_in_name("0.05.png")->ns, 50000000);
  for (const char* name :
       {"1.png.png", ".5.png", "1..png", "1.5.5.png", "1.1234567890.png", "9999999999999.5.png", "a1.5.png"})
    EXPECT_FALSE(time_in_name(name)) << name;
}

TEST(HasImageEnding, KnowsEitherCase) {
  for (const char* name : {"a.png", "a.PNG", "a.Jpg", "a.jpeg", "b/a.tiff"})
    EXPECT_TRUE(has_image_ending(name)) << name;
  for (const char* name : {"png", "a.png.123.part", "a.txt", "a"})
    EXPECT_FALSE(has_image_ending(name)) << name;
}

}  // namespace
}  // namespace apriltrack::test
