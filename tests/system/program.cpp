#include "program.h"

#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <sstream>

#include "support/shared_data.h"

namespace apriltrack::test {
namespace fs = std::filesystem;
namespace {

fs::path capture_file(const char* name) {
  static int number = 0;
  return fs::temp_directory_path() /
         ("apriltrack-system-" + std::to_string(::getpid()) + "-" + std::to_string(number++) + "." + name);
}

[[noreturn]] void become(const std::vector<std::string>& words, const fs::path& out, const fs::path& err) {
  std::vector<char*> arguments{const_cast<char*>(APRILTRACK_PROGRAM)};
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  const bool is_redirected = std::freopen("/dev/null", "r", stdin) &&
                             std::freopen(out.c_str(), "w", stdout) && std::freopen(err.c_str(), "w", stderr);
  if (is_redirected) ::execv(APRILTRACK_PROGRAM, arguments.data());
  ::_exit(127);
}

}  // namespace

std::string read_text(const fs::path& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

void write_text(const fs::path& path, const std::string& text) {
  fs::create_directories(path.parent_path());
  std::ofstream(path, std::ios::binary) << text;
}

ProgramRun run_program(const std::vector<std::string>& words) {
  const fs::path out = capture_file("out");
  const fs::path err = capture_file("err");
  const pid_t child = ::fork();
  if (child == 0) become(words, out, err);
  int wait_status = 0;
  ::waitpid(child, &wait_status, 0);
  const ProgramRun run{WIFEXITED(wait_status) ? WEXITSTATUS(wait_status) : 128 + WTERMSIG(wait_status),
                       read_text(out), read_text(err)};
  fs::remove(out);
  fs::remove(err);
  return run;
}

}  // namespace apriltrack::test
