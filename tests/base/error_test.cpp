#include "apriltrack/base/error.h"

#include <gmock/gmock.h>

#include "apriltrack/base/check.h"
#include "apriltrack/base/log.h"

namespace apriltrack {
namespace {

using testing::HasSubstr;

TEST(Error, SaysWhereAndWhat) {
  const Error error = invalid_input("maps/lab.yaml:14", "tag 7: size must be > 0 (is -0.16)");
  EXPECT_STREQ(error.what(), "maps/lab.yaml:14: tag 7: size must be > 0 (is -0.16)");
  EXPECT_STREQ(no_result("", "no tags seen").what(), "no tags seen") << "no place, no colon";
}

TEST(Error, KindsAreTheExitStatuses) {
  EXPECT_EQ(static_cast<int>(no_result("a", "b").kind()), 1);
  EXPECT_EQ(static_cast<int>(invalid_input("a", "b").kind()), 2);
  EXPECT_EQ(static_cast<int>(io_error("a", "b").kind()), 3);
}

TEST(Check, PassesWithoutEvaluatingTheMessage) {
  bool is_evaluated = false;
  const auto message = [&] {
    is_evaluated = true;
    return std::string("never");
  };
  APRILTRACK_CHECK(1 + 1 == 2, message());
  EXPECT_FALSE(is_evaluated);
}

TEST(Check, ABreachNamesThePlaceTheConditionAndTheMessage) {
  const int size = -1;
  try {
    APRILTRACK_CHECK(size > 0, "a tag's size must be positive");
    FAIL() << "the check passed";
  } catch (const MisuseError& error) {
    EXPECT_THAT(error.what(), HasSubstr("; error_test.cpp:")) << "no folders of the machine that built it";
    EXPECT_THAT(error.what(), HasSubstr("size > 0"));
    EXPECT_THAT(error.what(), HasSubstr("a tag's size must be positive"));
  }
}

TEST(Log, TheSilentSinkTakesAnything) {
  const LogSink sink = silent_log();
  ASSERT_TRUE(sink);
  EXPECT_NO_THROW(sink(LogLevel::kWarning, "anything"));
}

}  // namespace
}  // namespace apriltrack
