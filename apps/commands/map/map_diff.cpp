#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apriltrack/eval/compare_maps.h"
#include "apriltrack/eval/statistics.h"
#include "map_command.h"
#include "pages/json_units.h"

namespace apriltrack::app {
namespace {

using nlohmann::json;

json to_json(const Distribution& d) {
  return {{"rms", round_to_decimals(d.rms, kMetreDecimals)},
          {"median", round_to_decimals(d.median, kMetreDecimals)},
          {"max", round_to_decimals(d.max, kMetreDecimals)}};
}

json to_json(const MapComparison& comparison) {
  json out = {{"compared", comparison.tags.size()},
              {"missing", ids_of(comparison.missing)},
              {"extra", ids_of(comparison.extra)},
              {"position_m", to_json(comparison.position_m)},
              {"rotation_rad", to_json(comparison.rotation_rad)},
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
                  {"position_m", round_to_decimals(tag.position_m, kMetreDecimals)},
                  {"rotation_rad", round_to_decimals(tag.rotation_rad, kMetreDecimals)},
                  {"size_difference_m", round_to_decimals(tag.size_difference_m, kMetreDecimals)}};
    if (tag.nees_over_6) entry["nees_over_6"] = round_to_decimals(*tag.nees_over_6, 3);
    out["tags"].push_back(entry);
  }
  return with_older_units(std::move(out));
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
  const MapComparison comparison = with_both_maps(
      options, [](const TagMap& truth, const TagMap& estimate) { return compare_maps(truth, estimate); });
  for (const TagDifference& tag : comparison.tags) {
    if (std::abs(tag.size_difference_m) > 1e-9)
      options.console.warning(fmt::format("tag {}: sizes differ by {:.3f} mm", to_string(tag.key),
                                          kMmPerM * tag.size_difference_m));
  }
  options.console.finish(to_json(comparison), to_text(comparison));
}

}  // namespace

void add_map_diff(CLI::App& map_command) {
  const auto [verb, options] =
      add_map_verb(map_command, "diff",
                   {"Compares the tags of two maps after the best rigid motion, without scale.",
                    "apriltrack map diff true.yaml estimate.yaml", ""},
                   run_diff);
  add_map_input_options(*verb, options->input);
  verb->add_option("TRUE", options->first, "True tag map")->required();
  verb->add_option("ESTIMATE", options->second, "Tag map that is judged")->required();
}

}  // namespace apriltrack::app
