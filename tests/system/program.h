#pragma once

#include <gmock/gmock.h>

#include <filesystem>
#include <string>
#include <vector>

namespace apriltrack::test {

/// How one run of the program ended.
struct ProgramRun {
  int status = -1;
  std::string out;  ///< stdout
  std::string err;  ///< stderr
};

/// Runs `apriltrack <words>`, without a shell; HOME and the working folder are the test's own.
ProgramRun run_program(const std::vector<std::string>& words);

/// Status and a message, told together: a status without its cause is no use to anyone.
MATCHER_P2(EndsWith, status, message_part, "") {
  *result_listener << "status " << arg.status << ", stderr:\n" << arg.err;
  return arg.status == status && arg.err.find(message_part) != std::string::npos;
}

void write_text(const std::filesystem::path& path, const std::string& text);
std::string read_text(const std::filesystem::path& path);

}  // namespace apriltrack::test
