#include "console.h"

#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>

#include "apriltrack/base/error.h"
#include "apriltrack/base/version.h"

namespace apriltrack::app {
namespace {

bool g_has_answered_machines = false;
bool g_is_stdout_an_output = false;
// A signal handler may touch it as it needs no lock; threads at work ask it.
std::atomic<bool> g_interrupted = false;
static_assert(std::atomic<bool>::is_always_lock_free);

void on_interrupt(int signal) {
  g_interrupted = true;
  std::signal(signal, SIG_DFL);
}

constexpr std::chrono::milliseconds kTerminalPeriod{100};
constexpr std::chrono::seconds kPlainPeriod{5};
constexpr int kBarWidth = 24;

std::string format_duration(double seconds) {
  const int whole = static_cast<int>(seconds + 0.5);
  return fmt::format("{}:{:02d}", whole / 60, whole % 60);
}

std::string bar(std::size_t done, std::size_t total) {
  const auto filled =
      static_cast<std::size_t>(kBarWidth) * std::min(done, total) / std::max<std::size_t>(total, 1);
  return "[" + std::string(filled, '#') + std::string(kBarWidth - filled, '.') + "]";
}

}  // namespace

bool has_answered_machines() {
  return g_has_answered_machines;
}

bool is_interrupted() {
  return g_interrupted;
}

void install_interrupt_handler() {
  std::signal(SIGINT, on_interrupt);
  std::signal(SIGTERM, on_interrupt);  // of `kill` and of service managers
}

void Console::add_options(CLI::App& command) {
  command.add_flag("--json", json_, "Print a machine-readable summary on stdout");
  command.add_flag("--quiet", quiet_, "No progress, no talk: only warnings, errors and the answer");
}

void Console::info(std::string_view text) const {
  if (!quiet_) std::cerr << text << '\n';
}

void Console::warning(std::string_view text) const {
  std::cerr << "warning: " << text << '\n';
  warnings_->emplace_back(text);
}

LogSink Console::log() const {
  return [this](LogLevel level, std::string_view text) {
    if (level == LogLevel::kWarning) {
      warning(text);
    } else {
      info(text);
    }
  };
}

void print_json(std::ostream& stream, nlohmann::json answer) {
  // Raised where a key changes its meaning or goes away; further keys may come.
  constexpr int kSchemaVersion = 1;
  answer["program"] = "apriltrack";
  answer["program_version"] = version();
  answer["schema_version"] = kSchemaVersion;
  // A file's name may be any bytes; JSON is UTF-8, and what is not becomes U+FFFD.
  stream << answer.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) << std::endl;
}

void Console::finish(nlohmann::json summary, std::string_view text) const {
  std::ostream& stream = g_is_stdout_an_output ? std::cerr : std::cout;
  if (json_) {
    g_has_answered_machines = true;
    summary["warnings"] = warnings();
    print_json(stream, std::move(summary));
  } else {
    stream << text << '\n';
  }
  stream.flush();
  const bool is_silenced = stream.rdbuf() == nullptr;
  if (!stream && !is_silenced)
    throw io_error(g_is_stdout_an_output ? "standard error" : "standard output", "cannot be written");
}

void leave_stdout_to_output() {
  g_is_stdout_an_output = true;
}

AnswersAsTalk::AnswersAsTalk(const Console& console) : stdout_buffer_(std::cout.rdbuf()) {
  if (console.is_quiet()) {
    std::cout.rdbuf(nullptr);
  } else if (console.is_json()) {
    std::cout.rdbuf(std::cerr.rdbuf());
  }
}

AnswersAsTalk::~AnswersAsTalk() {
  std::cout.rdbuf(stdout_buffer_);
}

Progress::Progress(const Console& console, std::string label, std::optional<std::size_t> total)
    : is_quiet_(console.quiet_),
      is_terminal_(::isatty(STDERR_FILENO) == 1),
      label_(std::move(label)),
      total_(total),
      start_(std::chrono::steady_clock::now()),
      last_drawn_(start_) {}

Progress::~Progress() {
  if (done_ > 0) draw(true);
}

void Progress::advance(std::size_t by) {
  done_ += by;
  const auto now = std::chrono::steady_clock::now();
  const bool is_due = is_terminal_ ? now - last_drawn_ > kTerminalPeriod : now - last_drawn_ > kPlainPeriod;
  if (!is_due) return;
  last_drawn_ = now;
  draw(false);
}

ProgressSink progress_on(const Console& console) {
  return [&console](const std::string& task, std::optional<std::size_t> steps) {
    const auto progress = std::make_shared<Progress>(console, task, steps);
    return ProgressStep([progress] { progress->advance(); });
  };
}

void Progress::draw(bool is_last) {
  if (is_quiet_) return;
  const double elapsed_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  const double rate = elapsed_s > 0.0 ? static_cast<double>(done_) / elapsed_s : 0.0;
  std::string line = label_ + " ";
  if (total_ && is_terminal_) line += bar(done_, *total_) + " ";
  line += total_ ? fmt::format("{}/{}", done_, *total_) : fmt::format("{}", done_);
  line += fmt::format(", {:.1f}/s", rate);
  if (is_last) {
    line += fmt::format(", {} in all", format_duration(elapsed_s));
  } else if (total_ && rate > 0.0 && *total_ > done_) {
    line += fmt::format(", {} left", format_duration(static_cast<double>(*total_ - done_) / rate));
  }
  const bool ends_line = is_last || !is_terminal_;
  std::cerr << (is_terminal_ ? "\r\033[K" : "") << line << (ends_line ? "\n" : "") << std::flush;
}

}  // namespace apriltrack::app
