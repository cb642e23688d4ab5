#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "support/judges.h"

namespace apriltrack::test {

struct JudgeRun {
  bool is_content = false;
  std::string talk;
};

/// What another project's program says of a file.
inline JudgeRun ask_judge(const std::string& command, const std::filesystem::path& folder) {
  const auto log = folder / "judge.log";
  JudgeRun run;
  run.is_content = std::system(("(" + command + ") >'" + log.string() + "' 2>&1").c_str()) == 0;
  std::ostringstream text;
  text << std::ifstream(log).rdbuf();
  run.talk = text.str();
  return run;
}

}  // namespace apriltrack::test
