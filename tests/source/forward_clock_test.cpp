#include "forward_clock.h"

#include <gmock/gmock.h>

namespace apriltrack::test {
namespace {

using ::testing::HasSubstr;

TEST(ForwardClock, TakesTimesThatRunForward) {
  ForwardClock clock;
  for (const std::int64_t ns : {-5, 0, 1, 1'000'000'000}) {
    EXPECT_EQ(clock.take(Timestamp{ns}), "");
    EXPECT_EQ(clock.time().ns, ns);
  }
}

// A driver that repeats a time, falls back, and leaves one out.
TEST(ForwardClock, PutsAFrameJustAfterTheOneBeforeWhereItsTimeCannotBeBelieved) {
  ForwardClock clock;
  EXPECT_EQ(clock.take(Timestamp{100}), "");
  EXPECT_THAT(clock.take(Timestamp{100}), HasSubstr("0.000000100 s, is not later"));
  EXPECT_EQ(clock.time().ns, 101);
  EXPECT_THAT(clock.take(Timestamp{40}), HasSubstr("0.000000040 s, is not later"));
  EXPECT_EQ(clock.time().ns, 102);
  EXPECT_THAT(clock.take(std::nullopt), HasSubstr("no time"));
  EXPECT_EQ(clock.time().ns, 103);
  EXPECT_EQ(clock.take(Timestamp{200}), "");
  EXPECT_EQ(clock.time().ns, 200);
}

TEST(ForwardClock, StartsAtZeroWithoutATime) {
  ForwardClock clock;
  EXPECT_THAT(clock.take(std::nullopt), HasSubstr("no time"));
  EXPECT_EQ(clock.time().ns, 0);
  EXPECT_EQ(clock.take(Timestamp{1}), "");
}

}  // namespace
}  // namespace apriltrack::test
