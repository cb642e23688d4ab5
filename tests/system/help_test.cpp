#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <sstream>
#include <string>

#include "program.h"
#include "support/judges.h"
#include "support/shared_data.h"

namespace apriltrack::test {
namespace {

using ::testing::HasSubstr;
using ::testing::IsSupersetOf;
using ::testing::Not;

const std::vector<std::vector<std::string>> kSomeCommands = {
    {},        {"simulate"}, {"doctor"},         {"calibrate"},
    {"track"}, {"map"},      {"map", "convert"}, {"camera", "convert"}};

TEST(Help, IsTheSameByCommandAndByOption) {
  for (const std::vector<std::string>& command : kSomeCommands) {
    std::vector<std::string> by_option = command;
    by_option.push_back("--help");
    std::vector<std::string> by_command = {"help"};
    by_command.insert(by_command.end(), command.begin(), command.end());
    const ProgramRun run = run_program(by_command);
    EXPECT_EQ(run.status, 0) << run.err;
    EXPECT_EQ(run.out, run_program(by_option).out);
  }
  EXPECT_THAT(run_program({"help", "map", "fold"}),
              EndsWith(2, "apriltrack map has no command 'fold'; it has: show, convert"));
  EXPECT_EQ(run_program({"-v"}).out, run_program({"--version"}).out);
}

TEST(Help, FitsTheWidthButForCommandLinesToPaste) {
  for (std::vector<std::string> command : kSomeCommands) {
    command.push_back("--help");
    std::istringstream lines(run_program(command).out);
    for (std::string line; std::getline(lines, line);) {
      const bool is_to_paste = line.find("  apriltrack ") == 0;
      if (is_to_paste) continue;
      EXPECT_LE(line.size(), 100U) << line;
    }
  }
}

TEST(Help, TellsValuesDefaultsAndWhatIsRequired) {
  const std::string help = run_program({"track", "--help"}).out;
  EXPECT_THAT(help, HasSubstr("--map FILE "));
  EXPECT_THAT(help, HasSubstr("--mode ego|joint "));
  EXPECT_THAT(help, HasSubstr("(default: ego)"));
  EXPECT_THAT(help, HasSubstr("(required)"));
  EXPECT_THAT(help, Not(HasSubstr("TEXT")));
}

// groff's own reading of them.
TEST(ManualPages, AreThereForEveryCommandAndSetWithoutAWarning) {
  const std::filesystem::path folder = temporary_folder();
  ASSERT_EQ(run_program({"help", "--man-folder", folder / "man"}).status, 0);
  EXPECT_THAT(names_in(folder / "man"),
              IsSupersetOf({"apriltrack.1", "apriltrack-track.1", "apriltrack-map-convert.1"}));
  EXPECT_EQ(read_text(folder / "man" / "apriltrack-track.1"), run_program({"help", "track", "--man"}).out);
  APRILTRACK_NEED_JUDGE(program_judge("groff", "groff"));
  for (const std::string& page : names_in(folder / "man")) {
    const std::string command = "cd '" + (folder / "man").string() +
                                "' && groff -man -Tutf8 -P-cbou -ww -rLL=100n '" + page + "' > '" +
                                (folder / "page").string() + "' 2> '" + (folder / "warnings").string() + "'";
    EXPECT_EQ(std::system(command.c_str()), 0) << page;
    EXPECT_EQ(read_text(folder / "warnings"), "") << page;
    for (const char* section : {"NAME", "SYNOPSIS", "OPTIONS", "EXIT STATUS"})
      EXPECT_THAT(read_text(folder / "page"), HasSubstr(section)) << page;
  }
}

}  // namespace
}  // namespace apriltrack::test
