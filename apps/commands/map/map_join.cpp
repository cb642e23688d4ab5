#include <fmt/format.h>

#include <cmath>

#include "apriltrack/eval/combine_maps.h"
#include "apriltrack/eval/statistics.h"
#include "cli/option_checks.h"
#include "files/outputs.h"
#include "map_command.h"
#include "pages/json_units.h"

namespace apriltrack::app {
namespace {

using nlohmann::json;

/// A second time the value grows: keys of a block are unique.
void note(TagMap& map, const std::string& key, const std::string& value) {
  for (auto& [known, text] : map.provenance) {
    if (known != key) continue;
    text += ", " + value;
    return;
  }
  map.provenance.emplace_back(key, value);
}

/// Maps of one place differ by millimetres; those of two places that share ids, or with a tag that moved, by
/// more.
void warn_of_misfit(const MapComparison& fit, const Console& console) {
  const MergeOptions limits;
  const TagDifference& worst = fit.tags[fit.worst];
  if (worst.position_m > limits.max_position_difference_m ||
      fit.rotation_rad.max > limits.max_rotation_difference_rad)
    console.warning(
        fmt::format("the maps differ by up to {:.1f} mm ({}) and {:.2f} deg: are they of one place?",
                    kMmPerM * worst.position_m, to_string(worst.key), kDegPerRad * fit.rotation_rad.max));
  for (const TagDifference& tag : fit.tags) {
    if (std::abs(tag.size_difference_m) > 1e-9)
      console.warning(fmt::format("tag {}: sizes differ by {:.3f} mm", to_string(tag.key),
                                  kMmPerM * tag.size_difference_m));
  }
}

void run_align(const MapOptions& options) {
  check_output(options.output, "--output", {options.first, options.second});
  AlignedMap aligned = with_both_maps(
      options, [](const TagMap& reference, const TagMap& map) { return align_map(reference, map); });
  note(aligned.map, "aligned_onto", options.first);
  warn_of_misfit(aligned.fit, options.console);
  write_tag_map(options.output, aligned.map);
  const double rms_mm = kMmPerM * aligned.fit.position_m.rms;
  const double rms_deg = kDegPerRad * aligned.fit.rotation_rad.rms;
  options.console.finish(
      with_older_units({{"common_tags", aligned.common_tags},
                        {"position_rms_m", round_to_decimals(aligned.fit.position_m.rms, kMetreDecimals)},
                        {"rotation_rms_rad", round_to_decimals(aligned.fit.rotation_rad.rms, kMetreDecimals)},
                        {"tags", aligned.map.tags.size()},
                        {"output", options.output}}),
      fmt::format("{}: {} tags, brought onto {} by {} common tags, which then differ by "
                  "{:.1f} mm and {:.2f} deg RMS",
                  options.output, aligned.map.tags.size(), options.first, aligned.common_tags, rms_mm,
                  rms_deg));
}

json conflicts_json(const std::vector<MapConflict>& conflicts) {
  json out = json::array();
  for (const MapConflict& conflict : conflicts) {
    out.push_back({{"family", conflict.key.family},
                   {"id", conflict.key.id},
                   {"position_m", round_to_decimals(conflict.position_m, kMetreDecimals)},
                   {"rotation_rad", round_to_decimals(conflict.rotation_rad, kMetreDecimals)}});
  }
  return with_older_units(std::move(out));
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
  check_output(options.output, "--output", {options.first, options.second});
  MergedMap merged = with_both_maps(options, [&](const TagMap& base, const TagMap& addition) {
    return merge_maps(base, addition, {options.conflict_mm / kMmPerM, options.conflict_deg / kDegPerRad});
  });
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

}  // namespace

void add_map_align(CLI::App& map_command) {
  const auto [verb, options] =
      add_map_verb(map_command, "align",
                   {"Moves a map into another one's frame by their common tags.",
                    "apriltrack map align reference.yaml map.yaml --output aligned.yaml", ""},
                   run_align);
  add_map_input_options(*verb, options->input);
  verb->add_option("REFERENCE", options->first, "Tag map whose frame is taken")->required();
  verb->add_option("MAP", options->second, "Tag map that is moved")->required();
  verb->add_option("--output", options->output, "Tag map to write")->required();
}

void add_map_merge(CLI::App& map_command) {
  const auto [verb, options] =
      add_map_verb(map_command, "merge",
                   {"Adds the second map's tags to the first, joined by their common tags.",
                    "apriltrack map merge hall.yaml corridor.yaml --output building.yaml", ""},
                   run_merge);
  add_map_input_options(*verb, options->input);
  verb->add_option("BASE", options->first, "Tag map that is kept as it is")->required();
  verb->add_option("ADDITION", options->second, "Tag map whose further tags are added")->required();
  verb->add_option("--output", options->output, "Tag map to write")->required();
  verb->add_option("--conflict-mm", options->conflict_mm, "Common tags farther apart are reported")
      ->check(number_at_least(0.0))
      ->capture_default_str();
  verb->add_option("--conflict-deg", options->conflict_deg, "Common tags turned by more are reported")
      ->check(number_at_least(0.0))
      ->capture_default_str();
}

}  // namespace apriltrack::app
