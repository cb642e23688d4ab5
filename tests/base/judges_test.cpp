// What tests that compare with other projects do where these are absent.

#include "support/judges.h"

#include <gmock/gmock.h>
#include <gtest/gtest-spi.h>

#include <cstdlib>
#include <optional>

namespace apriltrack::test {
namespace {
using ::testing::HasSubstr;

/// Sets a variable of the environment, or none, while it is there.
class Environment {
 public:
  Environment(const char* name, const char* value) : name_(name) {
    if (const char* const before = std::getenv(name)) before_ = before;
    set(value);
  }
  ~Environment() { set(before_ ? before_->c_str() : nullptr); }
  Environment(const Environment&) = delete;
  Environment& operator=(const Environment&) = delete;

 private:
  void set(const char* value) const {
    if (value != nullptr)
      ::setenv(name_, value, 1);
    else
      ::unsetenv(name_);
  }
  const char* name_;
  std::optional<std::string> before_;
};

Judge absent() {
  return program_judge("no-such-program", "its-package");
}

/// A test's body; what it gives is the kind of result with which it ended.
::testing::TestPartResult::Type result_without(const Judge& judge) {
  ::testing::TestPartResultArray results;
  {
    ::testing::ScopedFakeTestPartResultReporter reporter(
        ::testing::ScopedFakeTestPartResultReporter::INTERCEPT_ONLY_CURRENT_THREAD, &results);
    const auto body = [&] {
      APRILTRACK_NEED_JUDGE(judge);
      SUCCEED();
    };
    body();
  }
  EXPECT_EQ(results.size(), 1);
  return results.GetTestPartResult(0).type();
}

TEST(Judges, AreNamedWhereTheyAreAbsent) {
  EXPECT_THAT(missing_judge(absent()), HasSubstr("no-such-program is not installed (package its-package;"));
  EXPECT_EQ(missing_judge(program_judge("sh", "dash")), "");
  EXPECT_THAT(missing_judge(std::vector{program_judge("sh", "dash"), absent()}),
              HasSubstr("no-such-program"));
  EXPECT_THAT(missing_judge(python_judge("sys, no_such_module", "python3-none")),
              HasSubstr("Python's sys, no_such_module"));
  EXPECT_EQ(missing_judge(python_judge("sys, json", "python3")), "");
}

TEST(Judges, AreSkippedWhereTheyAreAbsentAndFailWhereTheyAreRequired) {
  using Result = ::testing::TestPartResult;
  const Environment anything("APRILTRACK_JUDGES", nullptr);
  EXPECT_EQ(result_without(absent()), Result::kSkip);
  EXPECT_EQ(result_without(program_judge("sh", "dash")), Result::kSuccess);
  const Environment required("APRILTRACK_JUDGES", "required");
  EXPECT_EQ(result_without(absent()), Result::kFatalFailure);
  EXPECT_EQ(result_without(program_judge("sh", "dash")), Result::kSuccess);
}

}  // namespace
}  // namespace apriltrack::test
