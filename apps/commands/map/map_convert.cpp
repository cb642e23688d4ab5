#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <variant>

#include "apriltrack/export/export_map.h"
#include "apriltrack/tags/map_formats.h"
#include "cli/choice_option.h"
#include "cli/option_checks.h"
#include "files/format_choice.h"
#include "files/loss_words.h"
#include "files/map_oddity_words.h"
#include "files/outputs.h"
#include "map_command.h"

namespace apriltrack::app {
namespace {

namespace fs = std::filesystem;

/// What can be written.
using OutputFormat = std::variant<MapFormat, ExportFormat>;

std::optional<OutputFormat> format_called(std::string_view name) {
  if (const auto format = map_format_named(name)) return OutputFormat(*format);
  if (const auto format = export_format_named(name)) return OutputFormat(*format);
  return std::nullopt;
}

std::optional<OutputFormat> output_of_ending(const fs::path& path) {
  if (const auto format = map_format_of_ending(path)) return OutputFormat(*format);
  if (const auto format = format_of_ending(export_formats(), path)) return OutputFormat(*format);
  return std::nullopt;
}

std::vector<OfferedFormat> offered() {
  return offered_formats(map_formats(), export_formats());
}

std::string_view name_of(const OutputFormat& output) {
  return std::visit([](const auto format) { return info_of(format).name; }, output);
}

std::string_view title_of(const OutputFormat& output) {
  return std::visit([](const auto format) { return info_of(format).title; }, output);
}

bool is_folder(const OutputFormat& output) {
  const auto* format = std::get_if<ExportFormat>(&output);
  return format && info_of(*format).is_folder;
}

OutputKind kind_of(const OutputFormat& output) {
  return output == OutputFormat(ExportFormat::kGlb) ? OutputKind::kGlb : OutputKind::kText;
}

std::optional<FieldSize> field_of(const MapOptions& options) {
  if (options.field_length_m.has_value() != options.field_width_m.has_value())
    throw invalid_input(options.field_length_m ? "--field-width" : "--field-length",
                        "is required beside the other: a field has a length and a width");
  if (!options.field_length_m) return std::nullopt;
  return FieldSize{*options.field_length_m, *options.field_width_m};
}

std::vector<ConversionLoss> write_as(const OutputFormat& output, const std::string& path, const TagMap& map,
                                     const MapWriteOptions& options) {
  if (const auto* format = std::get_if<MapFormat>(&output))
    return write_tag_map_as(path, map, *format, options);
  return write_exported_map(path, map, std::get<ExportFormat>(output));
}

/// Of the map, without those that the format cannot hold.
std::size_t num_written(const TagMap& map, const std::vector<ConversionLoss>& losses) {
  std::size_t count = map.tags.size();
  for (const ConversionLoss& loss : losses)
    if (loss.kind == LossKind::kTags && loss.how == LossHow::kLeftOut) count -= loss.which.size();
  return count;
}

void run_convert(const MapOptions& options) {
  const OutputFormat output =
      format_to_write(options.to, options.second, format_called, output_of_ending, offered());
  if (is_folder(output))
    check_output_folder(options.second);
  else
    check_output(options.second, "OUT", {options.first, options.input.tag_sizes}, kind_of(output));
  if (!is_folder(output)) check_ending(options.second, name_of(output), offered(), "--to", options.console);
  MapReadOptions read_options = options.input.read_options();
  read_options.field = field_of(options);
  const MapReading reading = read_tag_map(options.first, read_options);
  const std::vector<ConversionLoss> losses =
      write_as(output, options.second, reading.map, {.field = read_options.field});
  const std::string_view from = info_of(reading.format).title;
  nlohmann::json reported =
      report_losses(reading.losses, {.title = from, .file = options.first}, options.console);
  tell_oddities(reading.map, options.first, options.console);
  append(reported, report_losses(losses, {ConversionStep::Stage::kWrite, title_of(output), options.second},
                                 options.console));
  options.console.finish({{"input", options.first},
                          {"output", options.second},
                          {"from", info_of(reading.format).name},
                          {"to", name_of(output)},
                          {"frame", reading.map.frame},
                          {"tags", num_written(reading.map, losses)},
                          {"losses", reported},
                          {"oddities", oddities_json(reading.map)}},
                         fmt::format("{}: {} tags, a {} from a {}", options.second,
                                     num_written(reading.map, losses), title_of(output), from));
}

/// One line a format, for --help.
std::string formats_text() {
  std::string text = "Formats that are read, by their contents, and written:\n";
  for (const MapFormatInfo& info : map_formats()) text += fmt::format("  {:<14}{}\n", info.name, info.title);
  text += "Formats that are written:\n";
  for (const ExportFormatInfo& info : export_formats())
    text += fmt::format("  {:<14}{}{}\n", info.name, info.title, info.is_folder ? "; OUT is a folder" : "");
  return text +
         "Without --to the ending of OUT decides: .yaml (ours), .fmap, .ini, .gltf, .glb, .urdf, .sdf, "
         ".g2o.\n"
         "What a format cannot hold, or does not say, is reported on stderr, and under --json in `losses`.";
}

}  // namespace

void add_map_convert(CLI::App& map_command) {
  const auto [verb, options] =
      add_map_verb(map_command, "convert",
                   {"Reads a layout of tags of any known project, and writes it for another.",
                    "apriltrack map convert 2024-crescendo.json map.yaml --tag-size 0.1651\n"
                    "apriltrack map convert map.yaml tags.yaml --to apriltag_ros",
                    formats_text()},
                   run_convert);
  verb->add_option("IN", options->first, "Tag map, or layout of tags of another project")->required();
  verb->add_option("OUT", options->second, "File to write; of --to colmap a folder")->required();
  const std::vector<std::string> names = names_of(offered());
  offer_words(
      *verb->add_option("--to", options->to, fmt::format("Format to write: {}", fmt::join(names, ", "))),
      "FORMAT", names);
  add_map_input_options(*verb, options->input);
  verb->add_option(
          "--field-length", options->field_length_m,
          "Metres along x, of WPILib's and Limelight's fields: moves the origin between corner and centre")
      ->check(number_between(0.01, 10'000.0));
  verb->add_option("--field-width", options->field_width_m, "Metres along y")
      ->check(number_between(0.01, 10'000.0));
}

}  // namespace apriltrack::app
