#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <iostream>

#include "apriltrack/base/error.h"
#include "apriltrack/io/atomic_file.h"
#include "choice_option.h"
#include "command_help.h"
#include "commands.h"
#include "help_text.h"
#include "manual_page.h"
#include "shell_completion.h"
#include "text_flow.h"

namespace apriltrack::app {
namespace {

struct HelpOptions {
  std::vector<std::string> words;
  bool as_manual = false;
  std::string manual_folder;
};

enum class Shell { kBash, kZsh, kFish };

std::vector<std::string> names_of(const std::vector<CommandTable>& commands) {
  std::vector<std::string> names;
  for (const CommandTable& command : commands) names.push_back(command.words.back());
  return names;
}

/// Throws Error(kInvalidInput) that lists the commands there are.
const CommandTable& command_at(const CommandTable& program, const std::vector<std::string>& words) {
  const CommandTable* place = &program;
  for (const std::string& word : words) {
    const auto is_it = [&](const CommandTable& own) { return own.words.back() == word; };
    const auto found = std::ranges::find_if(place->commands, is_it);
    if (found == place->commands.end())
      throw invalid_input(
          "help", fmt::format("{} has no command '{}'; it has: {}", joined(place->words), word,
                              place->commands.empty() ? "none" : joined(names_of(place->commands), ", ")));
    place = &*found;
  }
  return *place;
}

void give_help(const CLI::App& app, const HelpOptions& options) {
  const CommandTable program = option_table(app);
  if (!options.manual_folder.empty()) {
    std::filesystem::create_directories(options.manual_folder);
    for (const ManualFile& file : manual_files(program))
      write_file_atomically(std::filesystem::path(options.manual_folder) / file.name, file.text);
    return;
  }
  const CommandTable& command = command_at(program, options.words);
  std::cout << (options.as_manual ? manual_page(command) : help_text(command, terminal_width()));
}

void give_completion(const CLI::App& app, Shell shell) {
  const CommandTable program = option_table(app);
  switch (shell) {
    case Shell::kBash:
      std::cout << bash_completion(program);
      return;
    case Shell::kZsh:
      std::cout << zsh_completion(program);
      return;
    case Shell::kFish:
      std::cout << fish_completion(program);
      return;
  }
}

}  // namespace

void add_help_command(CLI::App& app) {
  CLI::App& command = add_command(app, "help",
                                  {"Prints the help of a command, or its manual page.",
                                   "apriltrack help map convert\n"
                                   "apriltrack help track --man | man -l -",
                                   ""});
  const auto options = std::make_shared<HelpOptions>();
  command.add_option("COMMAND", options->words, "Whose help; default: the list of commands");
  command.add_flag("--man", options->as_manual, "As a manual page, in roff");
  command.add_option("--man-folder", options->manual_folder,
                     "Write the manual pages of all commands into this folder");
  command.callback([&app, options] { give_help(app, *options); });
}

void add_completion_command(CLI::App& app) {
  CLI::App& command =
      add_command(app, "completion",
                  {"Prints a script that lets a shell complete commands, options and files.",
                   "apriltrack completion bash > ~/.local/share/bash-completion/completions/apriltrack\n"
                   "apriltrack completion fish > ~/.config/fish/completions/apriltrack.fish",
                   "Of zsh, a file _apriltrack in a folder of $fpath. The Debian package brings all three."});
  const auto shell = std::make_shared<Shell>(Shell::kBash);
  add_choice(command, "SHELL", *shell, {{"bash", Shell::kBash}, {"zsh", Shell::kZsh}, {"fish", Shell::kFish}},
             "Whose script")
      ->required();
  command.callback([&app, shell] { give_completion(app, *shell); });
}

}  // namespace apriltrack::app
