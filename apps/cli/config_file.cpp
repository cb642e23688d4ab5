#include "config_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <string>
#include <vector>

#include "apriltrack/io/yaml_reader.h"

namespace apriltrack::app {
namespace {

bool is_settable(const CLI::Option& option) {
  return option.get_single_name() != "help" && option.get_single_name() != "config";
}

std::vector<std::string> settable_names(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options()) {
    if (is_settable(*option)) names.push_back(option->get_single_name());
  }
  return names;
}

CLI::Option* find_option(CLI::App& command, const std::string& key) {
  for (CLI::Option* option : command.get_options()) {
    if (!is_settable(*option)) continue;
    const std::vector<std::string>& names = option->get_lnames();  // --held-tag has two
    const bool is_named = option->get_single_name() == key || std::ranges::find(names, key) != names.end();
    if (is_named) return option;
  }
  return nullptr;
}

std::vector<std::string> values_of(const YamlNode& node) {
  if (!node.is_list()) return {node.as_string()};
  std::vector<std::string> values;
  for (const YamlNode& item : node.items()) values.push_back(item.as_string());
  return values;
}

void set_option(CLI::Option& option, const YamlNode& node) {
  try {
    if (option.get_expected_min() == 0) {  // a flag
      if (!node.as_bool()) return;
      option.add_result("true");
    } else {
      option.add_result(values_of(node));
    }
    option.run_callback();
  } catch (const CLI::ParseError& error) {
    node.fail(error.what());
  }
}

}  // namespace

void apply_config_file(CLI::App& command, const std::filesystem::path& path) {
  for (const auto& [key, node] : YamlNode::read_file(path).entries()) {
    CLI::Option* option = find_option(command, key);
    if (option == nullptr)
      node.fail(fmt::format("'{}' is no option of {}; there are: {}", key, command.get_name(),
                            fmt::join(settable_names(command), ", ")));
    if (option->count() == 0) set_option(*option, node);
  }
}

}  // namespace apriltrack::app
