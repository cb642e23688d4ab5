#include "command_help.h"

#include <CLI/CLI.hpp>
#include <memory>

#include "help_text.h"
#include "option_table.h"
#include "text_flow.h"

namespace apriltrack::app {
namespace {

std::vector<std::string> parents_of(const CLI::App& command) {
  std::vector<std::string> words;
  for (const CLI::App* parent = command.get_parent(); parent != nullptr; parent = parent->get_parent())
    words.insert(words.begin(), parent->get_name());
  return words;
}

class TableFormatter : public StoredHelp {
 public:
  using StoredHelp::StoredHelp;
  std::string make_help(const CLI::App* command, std::string, CLI::AppFormatMode) const override {
    return help_text(option_table(*command, parents_of(*command)), terminal_width());
  }
};

}  // namespace

void set_help(CLI::App& command, const CommandHelp& help) {
  command.description(help.summary);
  command.formatter(std::make_shared<TableFormatter>(help));
}

CLI::App& add_command(CLI::App& parent, const std::string& name, const CommandHelp& help) {
  CLI::App& command = *parent.add_subcommand(name, help.summary);
  set_help(command, help);
  return command;
}

}  // namespace apriltrack::app
