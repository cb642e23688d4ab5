#pragma once

#include <string>

namespace CLI {
class App;
}

namespace apriltrack::app {

/// What a command says of itself.
struct CommandHelp {
  std::string summary;   ///< One line: all that the list of commands shows.
  std::string examples;  ///< Command lines that can be pasted, one a line; its own --help begins with them.
  std::string details;   ///< Further text of its own --help; may be empty.
};

CLI::App& add_command(CLI::App& parent, const std::string& name, const CommandHelp& help);

/// Lets `command` print its --help from its option table. add_command() does so, too.
void set_help(CLI::App& command, const CommandHelp& help);

/// What add_command() or set_help() was given; nullptr where it was neither.
const CommandHelp* help_of(const CLI::App& command);

}  // namespace apriltrack::app
