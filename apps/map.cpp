#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>

#include "apriltrack/base/error.h"
#include "apriltrack/eval/combine_maps.h"
#include "apriltrack/eval/compare_maps.h"
#include "apriltrack/eval/statistics.h"
#include "commands.h"
#include "console.h"

namespace apriltrack::app {
namespace {

using nlohmann::json;

constexpr double kDegPerRad = 180.0 / std::numbers::pi;
constexpr double kMmPerM = 1e3;

struct MapOptions {
  std::string first;
  std::string second;
  std::string output;
  double conflict_mm = 10.0;
  double conflict_deg = 2.0;
  Console console;
};

double block_sigma(const Matrix6d& covariance, int first) {
  return std::sqrt(covariance.diagonal().segment<3>(first).sum());
}

// --- show ---

Eigen::Vector3d normal_map(const MapTag& tag) {  // towards who looks at the print
  return tag.T_map_tag.rotation() * -Eigen::Vector3d::UnitZ();
}

json to_json(const MapTag& tag) {
  const Eigen::Vector3d& p = tag.T_map_tag.translation();
  const Eigen::Quaterniond& q = tag.T_map_tag.rotation();
  const Eigen::Vector3d n = normal_map(tag);
  json out = {{"family", tag.key.family},
              {"id", tag.key.id},
              {"size_m", tag.size_m},
              {"position", {{"x", p.x()}, {"y", p.y()}, {"z", p.z()}}},
              {"orientation", {{"x", q.x()}, {"y", q.y()}, {"z", q.z()}, {"w", q.w()}}},
              {"normal", {n.x(), n.y(), n.z()}}};
  if (tag.covariance) {
    out["sigma_position_m"] = block_sigma(*tag.covariance, 0);
    out["sigma_rotation_rad"] = block_sigma(*tag.covariance, 3);
  }
  if (const auto& statistics = tag.statistics) {
    out["statistics"] = {{"views", statistics->views},
                         {"residual_rms_px", statistics->residual_rms_px},
                         {"flags", statistics->flags}};
  }
  return out;
}

json to_json(const TagMap& map) {
  json out = {{"frame", map.frame},
              {"default_family", map.default_family},
              {"tags", json::array()},
              {"provenance", json::object()}};
  for (const MapTag& tag : map.tags) out["tags"].push_back(to_json(tag));
  for (const auto& [key, value] : map.provenance) out["provenance"][key] = value;
  return out;
}

std::string join(const std::vector<std::string>& words) {
  return fmt::format("{}", fmt::join(words, " "));
}

std::string table_row(const MapTag& tag) {
  const Eigen::Vector3d& p = tag.T_map_tag.translation();
  const Eigen::Vector3d n = normal_map(tag);
  std::string text =
      fmt::format("{:<18}{:>8.1f}{:>10.4f}{:>10.4f}{:>10.4f}{:>7.2f}{:>6.2f}{:>6.2f}", to_string(tag.key),
                  kMmPerM * tag.size_m, p.x(), p.y(), p.z(), n.x(), n.y(), n.z());
  const bool has_sigma = tag.covariance.has_value();
  text += has_sigma ? fmt::format("{:>10.3f}{:>11.4f}", kMmPerM * block_sigma(*tag.covariance, 0),
                                  kDegPerRad * block_sigma(*tag.covariance, 3))
                    : fmt::format("{:>10}{:>11}", "-", "-");
  text += tag.statistics ? fmt::format("{:>7}{:>9.3f}  {}", tag.statistics->views,
                                       tag.statistics->residual_rms_px, join(tag.statistics->flags))
                         : fmt::format("{:>7}{:>9}", "-", "-");
  text.erase(text.find_last_not_of(' ') + 1);
  return text + "\n";
}

std::string to_text(const TagMap& map) {
  std::string text = fmt::format("{} tags in frame '{}'\n", map.tags.size(), map.frame);
  text += fmt::format("{:<18}{:>8}{:>10}{:>10}{:>10}{:>19}{:>10}{:>11}{:>7}{:>9}\n", "tag", "size mm", "x m",
                      "y m", "z m", "normal", "sigma mm", "sigma deg", "views", "resid px");
  for (const MapTag& tag : map.tags) text += table_row(tag);
  for (const auto& [key, value] : map.provenance) text += fmt::format("{}: {}\n", key, value);
  text.pop_back();
  return text;
}

void run_show(const MapOptions& options) {
  const TagMap map = read_tag_map(options.first);
  options.console.finish(to_json(map), to_text(map));
}

// --- diff ---

json ids_of(const std::vector<TagKey>& keys) {
  json ids = json::array();
  for (const TagKey& key : keys) ids.push_back(key.id);
  return ids;
}

std::string names_of(const std::vector<TagKey>& keys) {
  std::vector<std::string> names;
  for (const TagKey& key : keys) names.push_back(to_string(key));
  return names.empty() ? "none" : join(names);
}

json to_json(const Distribution& d, double factor) {
  return {{"rms", round_to_decimals(factor * d.rms, 4)},
          {"median", round_to_decimals(factor * d.median, 4)},
          {"max", round_to_decimals(factor * d.max, 4)}};
}

json to_json(const MapComparison& comparison) {
  json out = {{"compared", comparison.tags.size()},
              {"missing", ids_of(comparison.missing)},
              {"extra", ids_of(comparison.extra)},
              {"position_mm", to_json(comparison.position_m, kMmPerM)},
              {"rotation_deg", to_json(comparison.rotation_rad, kDegPerRad)},
              {"worst_tag", comparison.tags[comparison.worst].key.id},
              {"tags", json::array()}};
  if (comparison.scale) out["scale"] = round_to_decimals(*comparison.scale, 6);
  if (const auto& nees = comparison.nees_over_6) {
    const auto judged = std::ranges::count_if(
        comparison.tags, [](const TagDifference& tag) { return tag.nees_over_6.has_value(); });
    out["nees_over_6"] = {{"tags", judged},
                          {"mean", round_to_decimals(nees->mean, 3)},
                          {"median", round_to_decimals(nees->median, 3)},
                          {"max", round_to_decimals(nees->max, 3)}};
  }
  for (const TagDifference& tag : comparison.tags) {
    json entry = {{"family", tag.key.family},
                  {"id", tag.key.id},
                  {"position_mm", round_to_decimals(kMmPerM * tag.position_m, 4)},
                  {"rotation_deg", round_to_decimals(kDegPerRad * tag.rotation_rad, 4)},
                  {"size_difference_mm", round_to_decimals(kMmPerM * tag.size_difference_m, 4)}};
    if (tag.nees_over_6) entry["nees_over_6"] = round_to_decimals(*tag.nees_over_6, 3);
    out["tags"].push_back(entry);
  }
  return out;
}

std::string to_text(const MapComparison& comparison) {
  std::string text = fmt::format("{:<18}{:>9}{:>9}{:>9}{:>10}{:>10}{:>9}\n", "tag", "dx mm", "dy mm", "dz mm",
                                 "|d| mm", "turn deg", "NEES/6");
  for (const TagDifference& tag : comparison.tags) {
    const Eigen::Vector3d d = kMmPerM * tag.offset_m;
    text += fmt::format("{:<18}{:>9.2f}{:>9.2f}{:>9.2f}{:>10.2f}{:>10.3f}{:>9}\n", to_string(tag.key), d.x(),
                        d.y(), d.z(), kMmPerM * tag.position_m, kDegPerRad * tag.rotation_rad,
                        tag.nees_over_6 ? fmt::format("{:.2f}", *tag.nees_over_6) : "-");
  }
  text += fmt::format(
      "{} tags compared after the best rigid motion: {:.2f} mm and {:.3f} deg RMS; worst {} ({:.2f} mm)\n",
      comparison.tags.size(), kMmPerM * comparison.position_m.rms, kDegPerRad * comparison.rotation_rad.rms,
      to_string(comparison.tags[comparison.worst].key), kMmPerM * comparison.position_m.max);
  text += fmt::format("missing: {}\nextra: {}", names_of(comparison.missing), names_of(comparison.extra));
  if (comparison.scale)
    text += fmt::format("\nscale: {:.6f} (1.01 = estimate 1 % too large)", *comparison.scale);
  if (const auto& nees = comparison.nees_over_6) {
    text += fmt::format(
        "\nnormalised error squared over 6 relative to {} (1 = honest): mean {:.3f}, median {:.3f}, max "
        "{:.3f}",
        to_string(*comparison.held_tag), nees->mean, nees->median, nees->max);
  }
  return text;
}

void run_diff(const MapOptions& options) {
  const MapComparison comparison = compare_maps(read_tag_map(options.first), read_tag_map(options.second));
  for (const TagDifference& tag : comparison.tags) {
    if (std::abs(tag.size_difference_m) > 1e-9)
      options.console.warning(fmt::format("tag {}: sizes differ by {:.3f} mm", to_string(tag.key),
                                          kMmPerM * tag.size_difference_m));
  }
  options.console.finish(to_json(comparison), to_text(comparison));
}

// --- align, merge ---

/// A second time the value grows: keys of a block are unique.
void note(TagMap& map, const std::string& key, const std::string& value) {
  for (auto& [known, text] : map.provenance) {
    if (known != key) continue;
    text += ", " + value;
    return;
  }
  map.provenance.emplace_back(key, value);
}

void run_align(const MapOptions& options) {
  AlignedMap aligned = align_map(read_tag_map(options.first), read_tag_map(options.second));
  note(aligned.map, "aligned_onto", options.first);
  write_tag_map(options.output, aligned.map);
  options.console.finish(
      {{"common_tags", aligned.common_tags}, {"tags", aligned.map.tags.size()}, {"output", options.output}},
      fmt::format("{}: {} tags, brought onto {} by {} common tags", options.output, aligned.map.tags.size(),
                  options.first, aligned.common_tags));
}

json conflicts_json(const std::vector<MapConflict>& conflicts) {
  json out = json::array();
  for (const MapConflict& conflict : conflicts) {
    out.push_back({{"family", conflict.key.family},
                   {"id", conflict.key.id},
                   {"position_mm", round_to_decimals(kMmPerM * conflict.position_m, 4)},
                   {"rotation_deg", round_to_decimals(kDegPerRad * conflict.rotation_rad, 4)}});
  }
  return out;
}

void warn_of(const MergedMap& merged, const Console& console) {
  for (const MapConflict& conflict : merged.conflicts) {
    console.warning(fmt::format(
        "tag {}: the maps differ by {:.1f} mm and {:.2f} deg; the first map's pose is kept",
        to_string(conflict.key), kMmPerM * conflict.position_m, kDegPerRad * conflict.rotation_rad));
  }
  if (!merged.without_covariance.empty()) {
    console.warning("covariances left out, because the second map's gauge is another: tags " +
                    names_of(merged.without_covariance));
  }
}

void run_merge(const MapOptions& options) {
  MergedMap merged = merge_maps(read_tag_map(options.first), read_tag_map(options.second),
                                {options.conflict_mm / kMmPerM, options.conflict_deg / kDegPerRad});
  note(merged.map, "merged_with", options.second);
  warn_of(merged, options.console);
  write_tag_map(options.output, merged.map);
  options.console.finish(
      {{"common_tags", merged.common_tags},
       {"added", ids_of(merged.added)},
       {"conflicts", conflicts_json(merged.conflicts)},
       {"tags", merged.map.tags.size()},
       {"output", options.output}},
      fmt::format("{}: {} tags, {} of them added over {} common tags, {} conflicts", options.output,
                  merged.map.tags.size(), merged.added.size(), merged.common_tags, merged.conflicts.size()));
}

using Run = void (*)(const MapOptions&);

std::pair<CLI::App*, std::shared_ptr<MapOptions>> add_verb(CLI::App& command, const std::string& name,
                                                           const std::string& help, Run run) {
  auto options = std::make_shared<MapOptions>();
  CLI::App* verb = command.add_subcommand(name, help);
  options->console.add_options(*verb);
  verb->callback([options, run] { run(*options); });
  return {verb, options};
}

void add_show(CLI::App& command) {
  const auto [verb, options] = add_verb(
      command, "show",
      "Example: apriltrack map show map.yaml\n\nLists a map's tags with sizes, poses, accuracy and origin.",
      run_show);
  verb->add_option("MAP", options->first, "Tag map")->required();
}

void add_diff(CLI::App& command) {
  const auto [verb, options] =
      add_verb(command, "diff",
               "Example: apriltrack map diff true.yaml estimate.yaml\n\n"
               "Compares the tags of both maps after the best rigid motion, without scale.",
               run_diff);
  verb->add_option("TRUE", options->first, "True tag map")->required();
  verb->add_option("ESTIMATE", options->second, "Tag map that is judged")->required();
}

void add_align(CLI::App& command) {
  const auto [verb, options] =
      add_verb(command, "align",
               "Example: apriltrack map align reference.yaml map.yaml --output aligned.yaml\n\n"
               "Moves a map into another one's frame by their common tags.",
               run_align);
  verb->add_option("REFERENCE", options->first, "Tag map whose frame is taken")->required();
  verb->add_option("MAP", options->second, "Tag map that is moved")->required();
  verb->add_option("--output", options->output, "Tag map to write")->required();
}

void add_merge(CLI::App& command) {
  const auto [verb, options] =
      add_verb(command, "merge",
               "Example: apriltrack map merge hall.yaml corridor.yaml --output building.yaml\n\n"
               "Adds the second map's tags to the first, joined by their common tags.",
               run_merge);
  verb->add_option("BASE", options->first, "Tag map that is kept as it is")->required();
  verb->add_option("ADDITION", options->second, "Tag map whose further tags are added")->required();
  verb->add_option("--output", options->output, "Tag map to write")->required();
  verb->add_option("--conflict-mm", options->conflict_mm, "Common tags farther apart are reported")
      ->capture_default_str();
  verb->add_option("--conflict-deg", options->conflict_deg, "Common tags turned by more are reported")
      ->capture_default_str();
}

}  // namespace

void add_map_command(CLI::App& app) {
  auto* command = app.add_subcommand(
      "map", "Example: apriltrack map diff true.yaml estimate.yaml\n\nShows, compares and joins tag maps.");
  command->require_subcommand(1);
  add_show(*command);
  add_diff(*command);
  add_align(*command);
  add_merge(*command);
}

}  // namespace apriltrack::app
