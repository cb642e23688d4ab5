#include "map_input.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>

#include "apriltrack/base/error.h"
#include "cli/option_checks.h"
#include "loss_words.h"
#include "map_oddity_words.h"

namespace apriltrack::app {
namespace {

bool was_given(const std::vector<ConversionLoss>& losses, LossKind kind) {
  return std::ranges::any_of(
      losses, [&](const ConversionLoss& loss) { return loss.kind == kind && loss.how == LossHow::kGiven; });
}

void refuse_unneeded(const MapInputOptions& input, const MapReading& first, const MapReading& second) {
  const auto is_needed = [&](LossKind kind) {
    return was_given(first.losses, kind) || was_given(second.losses, kind);
  };
  if ((input.tag_size_m || !input.tag_sizes.empty()) && !is_needed(LossKind::kSizes))
    throw invalid_input(input.tag_size_m ? "--tag-size" : "--tag-sizes",
                        "both maps state their sizes: leave it out");
  if (!input.family.empty() && !is_needed(LossKind::kFamilies))
    throw invalid_input("--family", "both maps name their families: leave it out");
}

}  // namespace

MapReadOptions MapInputOptions::read_options() const {
  if (tag_size_m && !(*tag_size_m > 0.0 && *tag_size_m <= 100.0))
    throw invalid_input("--tag-size", fmt::format("must be in (0, 100] metres (is {})", *tag_size_m));
  MapReadOptions options;
  options.sizes = tag_sizes.empty() ? TagSizes(tag_size_m) : read_tag_sizes(tag_sizes, tag_size_m);
  if (!family.empty()) options.family = family;
  options.bundle = bundle;
  return options;
}

void add_map_input_options(CLI::App& command, MapInputOptions& input) {
  command.add_option(
      "--tag-size", input.tag_size_m,
      "Of a layout that states none: edge length in metres of the square whose corners are detected "
      "(tag36h11: the outer edge of the black border)");
  command.add_option("--tag-sizes", input.tag_sizes,
                     "Of a layout that states none: YAML file with sizes by id");
  command
      .add_option("--family", input.family, "Of a layout that names none; default: tag36h11, with a warning")
      ->check(known_family());
  command.add_option("--bundle", input.bundle, "Which bundle or body of a file with several");
}

TagMap read_map_input(const std::string& path, const MapInputOptions& input, const Console& console) {
  MapReading reading = read_tag_map(path, input.read_options());
  report_losses(reading.losses, {.title = info_of(reading.format).title, .file = path}, console);
  tell_oddities(reading.map, path, console);
  return std::move(reading.map);
}

std::pair<TagMap, TagMap> read_map_inputs(const std::string& first, const std::string& second,
                                          const MapInputOptions& input, const Console& console) {
  MapReadOptions options = input.read_options();
  options.only_where_missing = true;
  MapReading a = read_tag_map(first, options);
  MapReading b = read_tag_map(second, options);
  refuse_unneeded(input, a, b);
  report_losses(a.losses, {.title = info_of(a.format).title, .file = first}, console);
  report_losses(b.losses, {.title = info_of(b.format).title, .file = second}, console);
  return {std::move(a.map), std::move(b.map)};
}

}  // namespace apriltrack::app
