#pragma once

#include <string>

#include "stored_help.h"

namespace CLI {
class App;
}

namespace apriltrack::app {

CLI::App& add_command(CLI::App& parent, const std::string& name, const CommandHelp& help);

/// Lets `command` print its --help from its option table. add_command() does so, too.
void set_help(CLI::App& command, const CommandHelp& help);

}  // namespace apriltrack::app
