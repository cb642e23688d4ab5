#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apriltrack/base/degrees.h"
#include "apriltrack/base/error.h"
#include "apriltrack/tags/tag_map.h"
#include "cli/command_help.h"
#include "cli/console.h"
#include "files/map_input.h"

namespace apriltrack::app {

constexpr double kMmPerM = 1e3;

/// What the verbs of `map` take; each uses some of it.
struct MapOptions {
  std::string first;
  std::string second;
  std::string output;
  std::string to;
  std::string report;
  MapInputOptions input;
  std::optional<double> field_length_m, field_width_m;
  double conflict_mm = 10.0;
  double conflict_deg = 2.0;
  Console console;
};

/// Adds a verb with the options of the console; the caller adds its own.
std::pair<CLI::App*, std::shared_ptr<MapOptions>> add_map_verb(CLI::App& map_command, const std::string& name,
                                                               const CommandHelp& help,
                                                               void (*run)(const MapOptions&));

/// What `action` makes of the first and the second map. Where these do not fit, the error names both files:
/// the library knows of none.
template <class Action>
auto with_both_maps(const MapOptions& options, const Action& action) {
  const auto [first, second] = read_map_inputs(options.first, options.second, options.input, options.console);
  try {
    return action(first, second);
  } catch (const Error& error) {
    throw Error(error.kind(), options.first + " and " + options.second, error.what());
  }
}

void add_map_show(CLI::App& map_command);
void add_map_convert(CLI::App& map_command);
void add_map_diff(CLI::App& map_command);
void add_map_align(CLI::App& map_command);
void add_map_merge(CLI::App& map_command);
void add_map_print(CLI::App& map_command);

nlohmann::json ids_of(const std::vector<TagKey>& keys);
std::string names_of(const std::vector<TagKey>& keys);  ///< "none" where there are none.

}  // namespace apriltrack::app
