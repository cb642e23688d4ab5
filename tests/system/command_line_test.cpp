#include <gtest/gtest.h>

#include "program.h"

namespace apriltrack::test {
namespace {

using ::testing::HasSubstr;

const char* const kCommands[] = {"simulate", "detect", "calibrate", "track", "evaluate", "map", "demo"};

TEST(CommandLine, HelpOfEveryCommandShowsAnExampleFirst) {
  for (const std::string command : kCommands) {
    const ProgramRun run = run_program({command, "--help"});
    EXPECT_EQ(run.status, 0) << command;
    const std::size_t example = run.out.find("apriltrack " + command);
    const std::size_t options = run.out.find("Options:");
    EXPECT_NE(example, std::string::npos) << command << ":\n" << run.out;
    EXPECT_LT(example, options) << command << ":\n" << run.out;
  }
}

TEST(CommandLine, VersionIsTold) {
  const ProgramRun run = run_program({"--version"});
  EXPECT_EQ(run.status, 0);
  EXPECT_THAT(run.out, HasSubstr("apriltrack 0."));
}

TEST(CommandLine, WrongWordsEndWithStatus2AndAHint) {
  EXPECT_THAT(run_program({}), EndsWith(2, "--help"));
  EXPECT_THAT(run_program({"teleport"}), EndsWith(2, "teleport"));
  for (const std::string command : kCommands) {
    EXPECT_THAT(run_program({command, "--no-such-option"}), EndsWith(2, "--no-such-option")) << command;
  }
}

}  // namespace
}  // namespace apriltrack::test
