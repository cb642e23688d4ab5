#pragma once

#include <optional>
#include <string>
#include <utility>

#include "apriltrack/tags/map_formats.h"
#include "cli/console.h"

namespace CLI {
class App;
}

namespace apriltrack::app {

/// What a user may say of a layout whose file does not.
struct MapInputOptions {
  std::optional<double> tag_size_m;
  std::string tag_sizes;
  std::string family;
  std::string bundle;

  bool is_given() const { return tag_size_m || !tag_sizes.empty() || !family.empty() || !bundle.empty(); }
  /// Throws Error for sizes that are none, or a file of sizes that cannot be read.
  MapReadOptions read_options() const;
};

/// Adds --tag-size, --tag-sizes, --family and --bundle; `input` outlives the command.
void add_map_input_options(CLI::App& command, MapInputOptions& input);

/// A map of any format; what was assumed is told to the console. Throws as read_tag_map() does.
TagMap read_map_input(const std::string& path, const MapInputOptions& input, const Console& console);

/// The same of two maps, of which one may state what the other leaves open. An option that neither needs is
/// an error.
std::pair<TagMap, TagMap> read_map_inputs(const std::string& first, const std::string& second,
                                          const MapInputOptions& input, const Console& console);

}  // namespace apriltrack::app
