#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <utility>

namespace apriltrack::app {

/// What a command says of itself.
struct CommandHelp {
  std::string summary;   ///< One line: all that the list of commands shows.
  std::string examples;  ///< Command lines that can be pasted, one a line; its own --help begins with them.
  std::string details;   ///< Further text of its own --help; may be empty.
};

/// A formatter that keeps the words which it was made with, so that tables of options find them.
class StoredHelp : public CLI::FormatterBase {
 public:
  explicit StoredHelp(CommandHelp help) : help_(std::move(help)) {}
  const CommandHelp& help() const { return help_; }

 private:
  CommandHelp help_;
};

/// What add_command() or set_help() was given; nullptr where it was neither.
const CommandHelp* help_of(const CLI::App& command);

}  // namespace apriltrack::app
