#pragma once

#include <gmock/gmock.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <ostream>
#include <string>
#include <vector>

namespace apriltrack::test {

/// How one run of the program ended.
struct ProgramRun {
  int status = -1;
  std::string out;  ///< stdout
  std::string err;  ///< stderr
};

/// For messages of failed expectations.
void PrintTo(const ProgramRun& run, std::ostream* out);

/// Runs `apriltrack <words>`, without a shell.
ProgramRun run_program(const std::vector<std::string>& words);

/// The same with no file allowed to grow beyond `max_bytes`: to the program, a disk that is full.
ProgramRun run_program_on_full_disk(const std::vector<std::string>& words, std::size_t max_bytes);

/// What a run that must succeed answers under --json; a null value, and a failed expectation, where it does
/// not.
nlohmann::json run_for_json(std::vector<std::string> words);

/// Status and a message, told together: a status without its cause is no use to anyone.
MATCHER_P2(EndsWith, status, message_part, "") {
  return arg.status == status && arg.err.find(message_part) != std::string::npos;
}

void write_text(const std::filesystem::path& path, const std::string& text);
std::string read_text(const std::filesystem::path& path);

}  // namespace apriltrack::test
