#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "program.h"
#include "support/judges.h"
#include "support/shared_data.h"

// The shells themselves are asked what they would offer.

namespace apriltrack::test {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsSupersetOf;
using ::testing::Not;
using ::testing::UnorderedElementsAre;

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line.substr(0, line.find('\t')));
  return lines;
}

class Shell : public ::testing::Test {
 protected:
  void SetUp() override {
    for (const char* file : {"map_a.yaml", "map_b.yaml"}) write_text(folder_ / file, "");
    std::filesystem::create_directory(folder_ / "recording");
  }
  void complete_by(const std::string& shell, const std::string& file) {
    const ProgramRun run = run_program({"completion", shell});
    ASSERT_EQ(run.status, 0) << run.err;
    write_text(folder_ / file, run.out);
  }
  /// stdout of a script that this shell runs in the folder.
  std::vector<std::string> answer_of(const std::string& shell, const std::string& script) {
    write_text(folder_ / "ask", script);
    const std::string command =
        "cd '" + folder_.string() + "' && HOME=$PWD timeout 120 " + shell + " ./ask > answer 2> errors";
    EXPECT_EQ(std::system(command.c_str()), 0) << script;
    EXPECT_EQ(read_text(folder_ / "errors"), "");
    return lines_of(read_text(folder_ / "answer"));
  }

  const std::filesystem::path folder_ = temporary_folder();
};

class Bash : public Shell {
 protected:
  void SetUp() override {
    Shell::SetUp();
    complete_by("bash", "completion");
  }
  /// words: as the shell cut the line; the last one is what is completed.
  std::vector<std::string> offers(const std::string& words) {
    return answer_of("bash", "source ./completion\ncompopt() { :; }\nCOMP_WORDS=(" + words +
                                 ")\nCOMP_CWORD=$((${#COMP_WORDS[@]} - 1))\n_apriltrack\n"
                                 "for reply in \"${COMPREPLY[@]}\"; do echo \"$reply\"; done\n");
  }
};

TEST_F(Bash, OffersCommandsOptionsChoicesAndFiles) {
  EXPECT_THAT(offers("apriltrack tr"), Contains("track"));
  EXPECT_THAT(offers("apriltrack map ''"), IsSupersetOf({"show", "convert", "diff", "print"}));
  EXPECT_THAT(offers("apriltrack map convert --fam"), ElementsAre("--family"));
  EXPECT_THAT(offers("apriltrack track --mode ''"), UnorderedElementsAre("ego", "joint"));
  EXPECT_THAT(offers("apriltrack track --mode = j"), ElementsAre("joint"));
  EXPECT_THAT(offers("apriltrack map convert --to ''"),
              IsSupersetOf({"wpilib", "limelight", "glb", "colmap"}));
  EXPECT_THAT(offers("apriltrack camera convert --to m"), ElementsAre("mrcal"));
  EXPECT_THAT(offers("apriltrack camera convert --to eu"), ElementsAre()) << "read, not written";
  EXPECT_THAT(offers("apriltrack trajectory convert --to ''"), UnorderedElementsAre("tum", "euroc", "kitti"));
  EXPECT_THAT(offers("apriltrack track --map map_"), UnorderedElementsAre("map_a.yaml", "map_b.yaml"));
  EXPECT_THAT(offers("apriltrack map print map_"), UnorderedElementsAre("map_a.yaml", "map_b.yaml"));
  EXPECT_THAT(offers("apriltrack map print map_a.yaml --output ''"), ElementsAre("recording"));  // a folder
  EXPECT_THAT(offers("apriltrack track --seed ''"), ElementsAre());
}

class Fish : public Shell {
 protected:
  void SetUp() override {
    APRILTRACK_NEED_JUDGE(program_judge("fish", "fish"));
    Shell::SetUp();
    complete_by("fish", "completion");
  }
  std::vector<std::string> offers(const std::string& line) {
    return answer_of("fish --no-config", "source ./completion\ncomplete -C '" + line + "'\n");
  }
};

TEST_F(Fish, OffersCommandsOptionsChoicesAndFiles) {
  EXPECT_THAT(offers("apriltrack tr"), UnorderedElementsAre("track", "trajectory"));
  EXPECT_THAT(offers("apriltrack map "), IsSupersetOf({"show", "convert", "diff", "print"}));
  EXPECT_THAT(offers("apriltrack map convert --fam"), ElementsAre("--family"));
  EXPECT_THAT(offers("apriltrack track --mode "), UnorderedElementsAre("ego", "joint"));
  EXPECT_THAT(offers("apriltrack track --map map_"), UnorderedElementsAre("map_a.yaml", "map_b.yaml"));
  EXPECT_THAT(offers("apriltrack track "), Not(Contains("convert")));
}

class Zsh : public Shell {
 protected:
  void SetUp() override {
    APRILTRACK_NEED_JUDGE(program_judge("zsh", "zsh"));
    Shell::SetUp();
    std::filesystem::create_directory(folder_ / "functions");
    complete_by("zsh", "functions/_apriltrack");
  }
  /// What an interactive zsh on a terminal of its own lists for this line.
  std::string listing(const std::string& line) {
    const std::string script =
        "zmodload zsh/zpty\n"
        "zpty asked zsh -f -i\n"
        "zpty -w asked \"stty columns 200; fpath=($PWD/functions \\$fpath); autoload -U compinit; compinit "
        "-u -D\"\n"
        "zpty -w asked \"unsetopt auto_menu; LISTMAX=1000; PS1=RE''ADY; print ST''ART\"\n"
        "zpty -r asked text '*START*READY*'\n"  // its line editor shows the prompt: keys are its own now
        "zpty -w -n asked '" +
        line +
        "'$'\\t\\x04\\x15'\n"  // complete, list, drop the line
        "zpty -w asked \"print DO''NE\"\n"
        "zpty -r asked text '*DONE*'\n"
        "print -r -- \"$text\"\n"
        "zpty -d asked\n";
    std::string listed;
    for (const std::string& text : answer_of("zsh -f", script)) listed += text + "\n";
    return listed;
  }
};

TEST_F(Zsh, OffersCommandsOptionsChoicesAndFiles) {
  EXPECT_THAT(listing("apriltrack map "),
              AllOf(::testing::HasSubstr("convert"), ::testing::HasSubstr("print")));
  EXPECT_THAT(listing("apriltrack track --mode="),
              AllOf(::testing::HasSubstr("ego"), ::testing::HasSubstr("joint")));
  EXPECT_THAT(listing("apriltrack track --map map_"),
              AllOf(::testing::HasSubstr("map_a.yaml"), ::testing::HasSubstr("map_b.yaml")));
}

}  // namespace
}  // namespace apriltrack::test
