#include "apriltrack/base/timestamp.h"

#include <gtest/gtest.h>

#include <limits>

namespace apriltrack {
namespace {

constexpr std::int64_t kEurocTime_ns =
    1403636579763555584;  // needs 61 bits: a double would lose the last digits

TEST(Timestamp, FormatsExactly) {
  EXPECT_EQ(format_seconds({0}), "0.000000000");
  EXPECT_EQ(format_seconds({1}), "0.000000001");
  EXPECT_EQ(format_seconds({12'034'000'000}), "12.034000000");
  EXPECT_EQ(format_seconds({kEurocTime_ns}), "1403636579.763555584");
  EXPECT_EQ(format_seconds({-1}), "-0.000000001");
  EXPECT_EQ(format_seconds({-1'500'000'000}), "-1.500000000");
  EXPECT_EQ(format_seconds({std::numeric_limits<std::int64_t>::max()}), "9223372036.854775807");
  EXPECT_EQ(format_seconds({std::numeric_limits<std::int64_t>::min()}), "-9223372036.854775808");
}

TEST(Timestamp, ReadsBackWhatItWrites) {
  for (const std::int64_t ns : {std::int64_t{0}, std::int64_t{1}, std::int64_t{-1}, std::int64_t{999'999'999},
                                std::int64_t{-1'000'000'001}, kEurocTime_ns, kEurocTime_ns + 1}) {
    EXPECT_EQ(parse_seconds(format_seconds({ns})), Timestamp{ns}) << ns;
  }
}

TEST(Timestamp, ReadsAnyNumberOfDecimals) {
  EXPECT_EQ(parse_seconds("12"), Timestamp{12'000'000'000});
  EXPECT_EQ(parse_seconds("12.5"), Timestamp{12'500'000'000});
  EXPECT_EQ(parse_seconds("12.0340000009"), Timestamp{12'034'000'000});
  EXPECT_EQ(parse_seconds("-0.25"), Timestamp{-250'000'000});
}

TEST(Timestamp, RefusesWhatIsNoTime) {
  for (const char* text : {"", "-", ".", "abc", "1.2.3", "1e9", "1.", "1.5s", " 1", "1 ", "+1", "--1", "nan",
                           "99999999999999999999", "9223372037.0"}) {
    EXPECT_EQ(parse_seconds(text), std::nullopt) << text;
  }
  for (const char* text : {"", "12.5", "-", "1e9", "0x10", " 1", "99999999999999999999"}) {
    EXPECT_EQ(parse_nanoseconds(text), std::nullopt) << text;
  }
}

TEST(Timestamp, ReadsNanosecondsOfFileNames) {
  EXPECT_EQ(parse_nanoseconds("1403636579763555584"), Timestamp{kEurocTime_ns});
  EXPECT_EQ(parse_nanoseconds("0033333333"), Timestamp{33'333'333});
}

TEST(Timestamp, DifferencesAndSums) {
  EXPECT_DOUBLE_EQ(seconds_between({kEurocTime_ns}, {kEurocTime_ns + 50'000'001}), 0.050000001);
  EXPECT_DOUBLE_EQ(seconds_between({10}, {0}), -1e-8);
  EXPECT_EQ(advance({kEurocTime_ns}, 0.05), Timestamp{kEurocTime_ns + 50'000'000});
  EXPECT_EQ(advance({0}, 0.6e-9), Timestamp{1});
  EXPECT_EQ(advance({0}, -0.6e-9), Timestamp{-1});
  EXPECT_LT(Timestamp{1}, Timestamp{2});
}

TEST(Timestamp, DifferencesOfTheFarthestTimesDoNotOverflow) {
  constexpr Timestamp kFirst{std::numeric_limits<std::int64_t>::min()};
  constexpr Timestamp kLast{std::numeric_limits<std::int64_t>::max()};
  EXPECT_EQ(nanoseconds_apart(kFirst, kLast), std::numeric_limits<std::uint64_t>::max());
  EXPECT_EQ(nanoseconds_apart(kLast, kFirst), std::numeric_limits<std::uint64_t>::max());
  EXPECT_EQ(nanoseconds_apart({-3}, {4}), 7U);
  EXPECT_EQ(nanoseconds_apart({4}, {4}), 0U);
  EXPECT_DOUBLE_EQ(seconds_between(kFirst, kLast), 18446744073.709551615);
  EXPECT_DOUBLE_EQ(seconds_between(kLast, kFirst), -18446744073.709551615);
  EXPECT_DOUBLE_EQ(seconds_between(kFirst, {0}), 9223372036.854775808);
}

}  // namespace
}  // namespace apriltrack
