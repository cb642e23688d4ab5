#pragma once

#include <chrono>
#include <cstddef>
#include <iosfwd>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <streambuf>
#include <string>
#include <string_view>
#include <vector>

#include "apriltrack/base/log.h"
#include "apriltrack/base/progress.h"

namespace CLI {
class App;
}

namespace apriltrack::app {

/// How a command talks: people are spoken to on stderr, the summary goes to stdout.
class Console {
 public:
  /// Adds --json and --quiet to a command.
  void add_options(CLI::App& command);

  bool is_json() const { return json_; }
  bool is_quiet() const { return quiet_; }

  void info(std::string_view text) const;     ///< Silent under --quiet.
  void warning(std::string_view text) const;  ///< Always heard.
  LogSink log() const;
  /// What warning() said so far, of this console and of its copies.
  const std::vector<std::string>& warnings() const { return *warnings_; }

  /// The end of a command: `summary` on stdout as JSON under --json, else `text` on stdout (even under
  /// --quiet, which hushes talk and not answers); after leave_stdout_to_output() on stderr. `summary`, an
  /// object, gets warnings() as "warnings". Throws Error(kIo) when stdout cannot be written.
  void finish(nlohmann::json summary, std::string_view text) const;

 private:
  friend class Progress;
  bool json_ = false;
  bool quiet_ = false;
  std::shared_ptr<std::vector<std::string>> warnings_ = std::make_shared<std::vector<std::string>>();
};

/// An answer for machines: `answer`, an object, with the version of the program and of the answers' schema.
void print_json(std::ostream& stream, nlohmann::json answer);

/// From now on answers go to stderr: stdout is a command's --output, or the file that it is sent to, and
/// takes what is written there alone.
void leave_stdout_to_output();

/// Whether finish() answered in JSON: there is one answer.
bool has_answered_machines();

/// While it lives, what commands answer on stdout is talk of a larger one whose own answer comes last: it
/// goes to stderr under --json, and nowhere under --quiet.
class AnswersAsTalk {
 public:
  explicit AnswersAsTalk(const Console& console);
  ~AnswersAsTalk();
  AnswersAsTalk(const AnswersAsTalk&) = delete;
  AnswersAsTalk& operator=(const AnswersAsTalk&) = delete;

 private:
  std::streambuf* const stdout_buffer_;
};

/// A bar with rate and time left on a terminal; a plain line every few seconds elsewhere; nothing under
/// --quiet, and of work that ended before its first step.
class Progress {
 public:
  /// total: nullopt when it is not known.
  Progress(const Console& console, std::string label, std::optional<std::size_t> total);
  ~Progress();

  void advance(std::size_t by = 1);

 private:
  void draw(bool is_last);

  const bool is_quiet_;
  const bool is_terminal_;
  const std::string label_;
  const std::optional<std::size_t> total_;
  std::size_t done_ = 0;
  std::chrono::steady_clock::time_point start_;
  std::chrono::steady_clock::time_point last_drawn_;
};

/// Shows work of the library as Progress does; `console` must outlive it.
ProgressSink progress_on(const Console& console);

/// True once the user pressed Ctrl-C: loops end early and keep what is done. A second Ctrl-C ends the
/// program.
bool is_interrupted();
/// What a command says that ended so and has a result none the less.
inline constexpr const char* kInterrupted = "interrupted: the result is that of the frames until then";
void install_interrupt_handler();

}  // namespace apriltrack::app
