#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "files/map_oddity_words.h"
#include "files/outputs.h"
#include "map_command.h"
#include "map_report.h"

namespace apriltrack::app {
namespace {

using nlohmann::json;

double block_sigma(const Matrix6d& covariance, int first) {
  return std::sqrt(covariance.diagonal().segment<3>(first).sum());
}

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
              {"position_m", {{"x", p.x()}, {"y", p.y()}, {"z", p.z()}}},
              {"position", {{"x", p.x()}, {"y", p.y()}, {"z", p.z()}}},  // as 0.1 called it, until 0.3
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

/// Of the columns of positions: of a map in UTM coordinates they are wide.
std::size_t position_width(const TagMap& map) {
  std::size_t width = 10;
  for (const MapTag& tag : map.tags)
    for (const double metres : tag.T_map_tag.translation())
      width = std::max(width, fmt::formatted_size("{:.4f}", metres) + 2);
  return width;
}

std::string table_row(const MapTag& tag, std::size_t width) {
  const Eigen::Vector3d& p = tag.T_map_tag.translation();
  const Eigen::Vector3d n = normal_map(tag);
  std::string text =
      fmt::format("{:<18}{:>8.1f}{:>{w}.4f}{:>{w}.4f}{:>{w}.4f}{:>7.2f}{:>6.2f}{:>6.2f}", to_string(tag.key),
                  kMmPerM * tag.size_m, p.x(), p.y(), p.z(), n.x(), n.y(), n.z(), fmt::arg("w", width));
  const bool has_sigma = tag.covariance.has_value();
  text += has_sigma ? fmt::format("{:>10.3f}{:>11.4f}", kMmPerM * block_sigma(*tag.covariance, 0),
                                  kDegPerRad * block_sigma(*tag.covariance, 3))
                    : fmt::format("{:>10}{:>11}", "-", "-");
  text += tag.statistics
              ? fmt::format("{:>7}{:>9.3f}  {}", tag.statistics->views, tag.statistics->residual_rms_px,
                            fmt::format("{}", fmt::join(tag.statistics->flags, " ")))
              : fmt::format("{:>7}{:>9}", "-", "-");
  text.erase(text.find_last_not_of(' ') + 1);
  return text + "\n";
}

std::string to_text(const TagMap& map) {
  const std::size_t width = position_width(map);
  std::string text = fmt::format("{} tags in frame '{}'\n", map.tags.size(), map.frame);
  text +=
      fmt::format("{:<18}{:>8}{:>{w}}{:>{w}}{:>{w}}{:>19}{:>10}{:>11}{:>7}{:>9}\n", "tag", "size mm", "x m",
                  "y m", "z m", "normal", "sigma mm", "sigma deg", "views", "resid px", fmt::arg("w", width));
  for (const MapTag& tag : map.tags) text += table_row(tag, width);
  for (const auto& [key, value] : map.provenance) text += fmt::format("{}: {}\n", key, value);
  text.pop_back();
  return text;
}

void run_show(const MapOptions& options) {
  if (!options.report.empty()) check_output(options.report, "--report", {options.first});
  const TagMap map = read_map_input(options.first, options.input, options.console);
  json summary = to_json(map);
  summary["oddities"] = oddities_json(map);
  std::string text = to_text(map);
  if (!options.report.empty()) {
    write_map_report(options.report, options.first, map);
    summary["report"] = options.report;
    text += "\nreport: " + options.report;
  }
  options.console.finish(summary, text);
}

}  // namespace

void add_map_show(CLI::App& map_command) {
  const auto [verb, options] = add_map_verb(map_command, "show",
                                            {"Lists a map's tags with sizes, poses, accuracy and origin.",
                                             "apriltrack map show map.yaml --report map.html",
                                             "The page shows the map in 3-D, to be turned about."},
                                            run_show);
  add_map_input_options(*verb, options->input);
  verb->add_option("MAP", options->first, "Tag map")->required();
  verb->add_option("--report", options->report,
                   "HTML page of the map: in 3-D, from above and from two sides");
}

}  // namespace apriltrack::app
