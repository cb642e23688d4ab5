#include "option_table.h"

#include <CLI/CLI.hpp>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string_view>

#include "stored_help.h"
#include "value_names.h"

namespace apriltrack::app {
namespace {

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// Of what CLI11 calls the type of a choice, "TEXT:{ego,joint}", or offer_words() "FORMAT:{tum,euroc}".
std::vector<std::string> choices_of(const std::string& type) {
  const std::size_t begin = type.find('{');
  const std::size_t end = type.rfind('}');
  if (begin == std::string::npos || end == std::string::npos) return {};
  std::vector<std::string> choices;
  std::istringstream stream(type.substr(begin + 1, end - begin - 1));
  for (std::string choice; std::getline(stream, choice, ',');) choices.push_back(choice);
  return choices;
}

/// "ego|joint", or the value's own name, where it has one.
std::string value_of_choice(const std::string& type, const std::vector<std::string>& choices) {
  const std::string name = type.substr(0, type.find(':'));
  const bool has_name = name != "TEXT" && name.find('{') == std::string::npos;
  return has_name ? name : joined(choices, "|");
}

std::vector<std::string> names_of(const CLI::Option& option) {
  std::vector<std::string> names;
  for (const std::string& name : option.get_snames()) names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) names.push_back("--" + name);
  return names;
}

OptionRow row_of(const CLI::Option& option) {
  OptionRow row;
  row.help = option.get_description();
  row.preset = option.get_default_str();
  row.is_required = option.get_required();
  row.is_repeatable = option.get_expected_max() > 1;
  if (!option.get_positional()) row.names = names_of(option);
  const bool is_flag = option.get_expected_max() == 0;
  if (is_flag) {
    row.preset.clear();
    return row;
  }
  const std::string type = option.get_type_name();
  row.choices = choices_of(type);
  row.value = row.choices.empty() ? type.substr(0, type.find(':')) : value_of_choice(type, row.choices);
  row.kind = row.choices.empty() ? kind_of_value(row.value) : ValueKind::kChoice;
  if (option.get_positional()) row.value = option.get_name(true);
  return row;
}

}  // namespace

CommandTable option_table(const CLI::App& command, const std::vector<std::string>& parents) {
  CommandTable table;
  table.words = parents;
  table.words.push_back(command.get_name());
  table.summary = command.get_description();
  if (const CommandHelp* help = help_of(command)) {
    table.summary = help->summary;
    table.details = help->details;
    table.examples = lines_of(help->examples);
  }
  for (const CLI::Option* option : command.get_options()) {
    OptionRow row = row_of(*option);
    (option->get_positional() ? table.positionals : table.options).push_back(std::move(row));
  }
  for (const CLI::App* own : command.get_subcommands([](const CLI::App*) { return true; }))
    table.commands.push_back(option_table(*own, table.words));
  return table;
}

std::string joined(const std::vector<std::string>& words, const std::string& glue) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : glue) + word;
  return text;
}

}  // namespace apriltrack::app
