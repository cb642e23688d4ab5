
#include <gtest/gtest.h>

#include <filesystem>
#include <iterator>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "program.h"
#include "support/shared_data.h"

namespace apriltrack::test {
namespace {

using ::testing::HasSubstr;

const char* const kCommands[] = {"simulate", "doctor", "detect",     "calibrate", "track", "evaluate",
                                 "map",      "camera", "trajectory", "demo",      "help",  "completion"};

/// What a list of commands says, by command.
std::map<std::string, std::string> listed_commands(const std::string& help) {
  std::istringstream lines(help.substr(help.find("Commands:\n")));
  std::map<std::string, std::string> summaries;
  std::string line;
  std::getline(lines, line);
  while (std::getline(lines, line) && !line.empty()) {
    EXPECT_EQ(line.find_first_not_of(' '), 2U) << "goes on over a second line: " << line;
    const std::size_t end = line.find(' ', 2);
    const std::size_t summary = line.find_first_not_of(' ', end);
    if (summary != std::string::npos) summaries[line.substr(2, end - 2)] = line.substr(summary);
  }
  return summaries;
}

TEST(CommandLine, APatternThatTheShellReplacedIsToldSo) {
  const std::string folder = temporary_folder();
  std::vector<std::string> words = {"track", "--output", folder + "/o.tum"};
  for (const char* name : {"/1.png", "/2.png", "/3.png"}) {
    write_text(folder + name, "");
    words.push_back(folder + name);
  }
  EXPECT_THAT(run_program(words),
              EndsWith(2,
                       "INPUT is one, and 2 more are given: for the pictures of a folder quote "
                       "the pattern, '" +
                           folder + "/*.png'"));
  words.push_back("--colour");
  EXPECT_THAT(run_program(words), EndsWith(2, "not understood"));
}

TEST(CommandLine, EveryCommandIsListedInOneShortLine) {
  const auto summaries = listed_commands(run_program({"--help"}).out);
  EXPECT_EQ(summaries.size(), std::size(kCommands));
  for (const std::string command : kCommands) EXPECT_TRUE(summaries.contains(command)) << command;
  for (const auto& [command, summary] : summaries) EXPECT_LE(summary.size(), 84U) << command;
}

void expect_example_first(std::vector<std::string> words) {
  std::string command = "apriltrack";
  for (const std::string& word : words) command += " " + word;
  words.push_back("--help");
  const ProgramRun run = run_program(words);
  EXPECT_EQ(run.status, 0) << command;
  EXPECT_THAT(run.out, ::testing::StartsWith("Example:\n  " + command + " ")) << command;
}

TEST(CommandLine, HelpOfEveryCommandBeginsWithAnExampleToPaste) {
  for (const std::string command : kCommands) expect_example_first({command});
}

TEST(CommandLine, HelpOfEveryVerbBeginsWithAnExampleToPaste) {
  for (const auto& [command, num_verbs] :
       {std::pair<std::string, std::size_t>{"map", 5}, {"camera", 2}, {"trajectory", 1}}) {
    const auto verbs = listed_commands(run_program({command, "--help"}).out);
    EXPECT_GE(verbs.size(), num_verbs) << command;
    for (const auto& [verb, summary] : verbs) expect_example_first({command, verb});
  }
}

TEST(CommandLine, VersionIsTold) {
  const ProgramRun run = run_program({"--version"});
  EXPECT_EQ(run.status, 0);
  EXPECT_THAT(run.out, HasSubstr("apriltrack 0."));
}

TEST(CommandLine, EveryAnswerForMachinesTellsProgramAndSchema) {
  const std::string version = run_program({"--version"}).out;
  for (const auto& words : {std::vector<std::string>{"--version", "--json"},
                            {"map", "show", "no_such_file", "--json"},
                            {"teleport", "--json"}}) {
    const auto answer = nlohmann::json::parse(run_program(words).out);
    EXPECT_EQ("apriltrack " + answer.at("program_version").get<std::string>() + "\n", version);
    EXPECT_EQ(answer.at("program").get<std::string>(), "apriltrack");
    EXPECT_EQ(answer.at("schema_version").get<int>(), 1);
  }
}

TEST(CommandLine, AMissingOrUnknownCommandIs2AndListsThoseThereAre) {
  for (const auto& words : {std::vector<std::string>{}, {"teleport"}, {"--quick"}}) {
    const ProgramRun run = run_program(words);
    for (const std::string command : kCommands) EXPECT_THAT(run, EndsWith(2, command));
  }
  EXPECT_THAT(run_program({"teleport"}),
              EndsWith(2, "apriltrack: there is no command 'teleport'; there are: simulate"));
  EXPECT_THAT(run_program({"map", "fold"}),
              EndsWith(2, "map: there is no command 'fold'; there are: show, convert"));
  EXPECT_THAT(run_program({"map"}), EndsWith(2, "map: a command is missing; there are: show, convert"));
}

TEST(CommandLine, WrongWordsEndWithStatus2AndAHint) {
  EXPECT_THAT(run_program({}), EndsWith(2, "--help"));
  EXPECT_THAT(run_program({"teleport"}), EndsWith(2, "teleport"));
  for (const std::string command : kCommands) {
    EXPECT_THAT(run_program({command, "--no-such-option"}), EndsWith(2, "--no-such-option")) << command;
  }
}

/// Its first step fails, for a file is in its way.
TEST(CommandLine, OfTheDemosStepsIsPrintedAsAShellReadsIt) {
  const std::string folder = temporary_folder() / "it's my demo";
  std::filesystem::create_directory(folder);
  write_text(folder + "/made_by_apriltrack_demo.txt", "");
  write_text(folder + "/gentle", "");
  const ProgramRun run = run_program({"demo", "--output", folder});
  EXPECT_NE(run.status, 0);
  const std::string parent = std::filesystem::path(folder).parent_path();
  EXPECT_THAT(run.err, HasSubstr("--output '" + parent + "/it'\\''s my demo/gentle' --force"));
}

}  // namespace
}  // namespace apriltrack::test
