#include "command_help.h"

#include <CLI/CLI.hpp>
#include <memory>
#include <sstream>

namespace apriltrack::app {
namespace {

std::string long_text(const CommandHelp& help) {
  std::string text = "Example:\n";
  std::istringstream examples(help.examples);
  for (std::string line; std::getline(examples, line);) text += "  " + line + "\n";
  text += "\n" + help.summary + "\n";
  if (!help.details.empty()) text += "\n" + help.details + "\n";
  return text + "\n";
}

/// CLI11 shows one description both in the list of commands and in a command's own help.
class CommandFormatter : public CLI::Formatter {
 public:
  explicit CommandFormatter(const CommandHelp& help) : text_(long_text(help)) {}
  std::string make_description(const CLI::App*) const override { return text_; }

 private:
  std::string text_;
};

}  // namespace

CLI::App& add_command(CLI::App& parent, const std::string& name, const CommandHelp& help) {
  CLI::App& command = *parent.add_subcommand(name, help.summary);
  command.formatter(std::make_shared<CommandFormatter>(help));
  return command;
}

}  // namespace apriltrack::app
