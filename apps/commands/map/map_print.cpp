#include <fmt/format.h>

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "apriltrack/io/atomic_file.h"
#include "apriltrack/io/staged_files.h"
#include "apriltrack/report/print_page.h"
#include "apriltrack/tags/tag_family.h"
#include "map_command.h"

namespace apriltrack::app {
namespace {
namespace fs = std::filesystem;

PrintPage page_of(const MapTag& tag) {
  const TagFamily& family = TagFamily::get(tag.key.family);
  return {tag.key.family,           tag.key.id, family.pattern(tag.key.id).cells(),
          family.width_at_border(), tag.size_m, family.has_reversed_border()};
}

void run_print(const MapOptions& options) {
  const TagMap map = read_map_input(options.first, options.input, options.console);
  std::vector<std::pair<fs::path, std::string>> pages;  // all are drawn first: a tag may not fit
  for (const MapTag& tag : map.tags) {
    const std::string name = fmt::format("{}_{:05}.svg", tag.key.family, tag.key.id);
    pages.emplace_back(fs::path(options.output) / name, print_page_svg(page_of(tag)));
  }
  StagedFiles staged;
  staged.make_folder(options.output);
  nlohmann::json files = nlohmann::json::array();
  for (const auto& page : pages) {
    staged.write(page.first, [&](const fs::path& path) { write_file_atomically(path, page.second); });
    files.push_back(page.first.string());
  }
  staged.commit();
  options.console.finish({{"pages", files}, {"output", options.output}},
                         fmt::format("{}: {} A4 pages, one tag each; print them at 100 % and measure a tag",
                                     options.output, pages.size()));
}

}  // namespace

void add_map_print(CLI::App& map_command) {
  const auto [verb, options] =
      add_map_verb(map_command, "print",
                   {"Draws each tag of a map on an A4 page of its own, at true scale.",
                    "apriltrack map print maps/wall_3x4.yaml --output pages",
                    "Pages are SVG files in millimetres, to be printed at 100 %. The poses do not matter."},
                   run_print);
  add_map_input_options(*verb, options->input);
  verb->add_option("MAP", options->first, "Tag map: families, ids and sizes are taken")->required();
  verb->add_option("--output", options->output, "Folder for the pages")->required();
}

}  // namespace apriltrack::app
