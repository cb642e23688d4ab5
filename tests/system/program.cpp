#include "program.h"

#include <linux/capability.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <optional>
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

/// Writing beyond the limit then fails as on a full disk; the captured stdout and stderr are under it too.
bool limit_file_size(std::size_t max_bytes) {
  const rlimit limit{max_bytes, max_bytes};
  return std::signal(SIGXFSZ, SIG_IGN) != SIG_ERR && ::setrlimit(RLIMIT_FSIZE, &limit) == 0;
}

/// The bounding set limits what root keeps across execv (capabilities(7)); others have nothing to lose.
bool give_up_override() {
  return ::geteuid() != 0 || ::prctl(PR_CAPBSET_DROP, CAP_DAC_OVERRIDE, 0, 0, 0) == 0;
}

/// What a run is denied.
struct Limits {
  std::optional<std::size_t> max_bytes;
  bool is_bound_by_permissions = false;
};

bool apply(const Limits& limits) {
  return (!limits.max_bytes || limit_file_size(*limits.max_bytes)) &&
         (!limits.is_bound_by_permissions || give_up_override());
}

[[noreturn]] void become(const std::vector<std::string>& words, const fs::path& out, const fs::path& err,
                         const Limits& limits) {
  std::vector<char*> arguments{const_cast<char*>(APRILTRACK_PROGRAM)};
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  const bool is_ready = std::freopen("/dev/null", "r", stdin) && std::freopen(out.c_str(), "w", stdout) &&
                        std::freopen(err.c_str(), "w", stderr) && apply(limits);
  if (is_ready) ::execv(APRILTRACK_PROGRAM, arguments.data());
  ::_exit(127);
}

int status_of(int wait_status) {
  return WIFEXITED(wait_status) ? WEXITSTATUS(wait_status) : 128 + WTERMSIG(wait_status);
}

ProgramRun take_captured(int wait_status, const fs::path& out, const fs::path& err) {
  ProgramRun ended{status_of(wait_status), read_text(out), read_text(err)};
  fs::remove(out);
  fs::remove(err);
  return ended;
}

ProgramRun run(const std::vector<std::string>& words, const Limits& limits) {
  const fs::path out = capture_file("out");
  const fs::path err = capture_file("err");
  const pid_t child = ::fork();
  if (child == 0) become(words, out, err, limits);
  int wait_status = 0;
  ::waitpid(child, &wait_status, 0);
  return take_captured(wait_status, out, err);
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

std::set<std::string> names_in(const fs::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.insert(entry.path().filename().string());
  return names;
}

void PrintTo(const ProgramRun& run, std::ostream* out) {
  *out << "status " << run.status << ", stderr:\n" << run.err;
}

ProgramRun run_program(const std::vector<std::string>& words) {
  return run(words, {});
}

ProgramRun run_program_on_full_disk(const std::vector<std::string>& words, std::size_t max_bytes) {
  return run(words, {.max_bytes = max_bytes, .is_bound_by_permissions = false});
}

ProgramRun run_program_bound_by_permissions(const std::vector<std::string>& words) {
  return run(words, {.max_bytes = std::nullopt, .is_bound_by_permissions = true});
}

ProgramRun run_program_without_reader(const std::vector<std::string>& words) {
  int ends[2];
  if (::pipe(ends) != 0) return {};
  ::close(ends[0]);
  const pid_t child = ::fork();
  if (child == 0) {
    std::signal(SIGPIPE, SIG_DFL);
    ::dup2(ends[1], STDOUT_FILENO);
    ::dup2(ends[1], STDERR_FILENO);
    std::vector<char*> arguments{const_cast<char*>(APRILTRACK_PROGRAM)};
    for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    ::execv(APRILTRACK_PROGRAM, arguments.data());
    ::_exit(127);
  }
  ::close(ends[1]);
  int wait_status = 0;
  ::waitpid(child, &wait_status, 0);
  return {status_of(wait_status), "", ""};
}

StartedProgram::StartedProgram(const std::vector<std::string>& words)
    : out_(capture_file("out")), err_(capture_file("err")), child_(::fork()) {
  if (child_ == 0) become(words, out_, err_, {});
}

StartedProgram::~StartedProgram() {
  if (has_ended_) return;
  if (is_running()) ::kill(child_, SIGKILL);
  finish();
}

bool StartedProgram::is_running() {
  if (!has_ended_) has_ended_ = ::waitpid(child_, &wait_status_, WNOHANG) == child_;
  return !has_ended_;
}

void StartedProgram::press_ctrl_c() {
  if (is_running()) ::kill(child_, SIGINT);
}

void StartedProgram::terminate() {
  if (is_running()) ::kill(child_, SIGTERM);
}

std::string StartedProgram::err_so_far() const {
  return read_text(err_);
}

ProgramRun StartedProgram::finish() {
  if (!has_ended_) ::waitpid(child_, &wait_status_, 0);
  has_ended_ = true;
  return take_captured(wait_status_, out_, err_);
}

nlohmann::json run_for_json(std::vector<std::string> words) {
  words.insert(words.end(), {"--json", "--quiet"});
  const ProgramRun run = run_program(words);
  EXPECT_EQ(run.status, 0) << run.err;
  return run.status == 0 ? nlohmann::json::parse(run.out) : nlohmann::json();
}

}  // namespace apriltrack::test
