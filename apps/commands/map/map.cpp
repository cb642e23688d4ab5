#include <fmt/format.h>
#include <fmt/ranges.h>

#include "cli/commands.h"
#include "map_command.h"

namespace apriltrack::app {

nlohmann::json ids_of(const std::vector<TagKey>& keys) {
  nlohmann::json ids = nlohmann::json::array();
  for (const TagKey& key : keys) ids.push_back(key.id);
  return ids;
}

std::string names_of(const std::vector<TagKey>& keys) {
  std::vector<std::string> names;
  for (const TagKey& key : keys) names.push_back(to_string(key));
  return names.empty() ? "none" : fmt::format("{}", fmt::join(names, " "));
}

std::pair<CLI::App*, std::shared_ptr<MapOptions>> add_map_verb(CLI::App& map_command, const std::string& name,
                                                               const CommandHelp& help,
                                                               void (*run)(const MapOptions&)) {
  CLI::App& verb = add_command(map_command, name, help);
  auto options = std::make_shared<MapOptions>();
  options->console.add_options(verb);
  verb.callback([options, run] { run(*options); });
  return {&verb, options};
}

void add_map_command(CLI::App& app) {
  CLI::App& command = add_command(app, "map",
                                  {"Shows, converts, compares, joins and prints tag maps.",
                                   "apriltrack map show map.yaml\n"
                                   "apriltrack map convert 2024-crescendo.json map.yaml --tag-size 0.1651\n"
                                   "apriltrack map diff true.yaml estimate.yaml",
                                   ""});
  command.require_subcommand(1);
  add_map_show(command);
  add_map_convert(command);
  add_map_diff(command);
  add_map_align(command);
  add_map_merge(command);
  add_map_print(command);
}

}  // namespace apriltrack::app
