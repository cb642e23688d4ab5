#pragma once

#include <gmock/gmock.h>
#include <sys/types.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <ostream>
#include <set>
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

/// The same without root's right to pass over the permissions of files, so that a test of them holds for
/// root, too.
ProgramRun run_program_bound_by_permissions(const std::vector<std::string>& words);

/// The same with nobody to read what goes to stdout and stderr, as after `| head`.
ProgramRun run_program_without_reader(const std::vector<std::string>& words);

/// A run that is not waited for, to be interrupted. What it is in is waited for by what it does, never by a
/// clock.
class StartedProgram {
 public:
  explicit StartedProgram(const std::vector<std::string>& words);
  ~StartedProgram();  ///< Kills it (SIGKILL), if it still runs.
  StartedProgram(const StartedProgram&) = delete;
  StartedProgram& operator=(const StartedProgram&) = delete;

  bool is_running();
  void press_ctrl_c();
  /// As `kill` does.
  void terminate();
  /// On stderr, until now.
  std::string err_so_far() const;
  /// Waits for its end.
  ProgramRun finish();

 private:
  std::filesystem::path out_;
  std::filesystem::path err_;
  pid_t child_ = -1;
  int wait_status_ = 0;
  bool has_ended_ = false;
};

/// What a run that must succeed answers under --json; a null value, and a failed expectation, where it does
/// not.
nlohmann::json run_for_json(std::vector<std::string> words);

/// Status and a message, told together: a status without its cause is no use to anyone.
MATCHER_P2(EndsWith, status, message_part, "") {
  return arg.status == status && arg.err.find(message_part) != std::string::npos;
}

void write_text(const std::filesystem::path& path, const std::string& text);
std::string read_text(const std::filesystem::path& path);
/// Of files and folders in it.
std::set<std::string> names_in(const std::filesystem::path& folder);

}  // namespace apriltrack::test
