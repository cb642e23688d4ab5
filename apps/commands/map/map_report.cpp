#include "map_report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "apriltrack/base/degrees.h"
#include "apriltrack/report/html_page.h"
#include "apriltrack/report/map_scene.h"
#include "pages/calibrate_scene.h"
#include "pages/map_drawings.h"

namespace apriltrack::app {
namespace {

std::string sizes_in_words(const TagMap& map) {
  std::set<double> sizes_mm;
  for (const MapTag& tag : map.tags) sizes_mm.insert(1e3 * tag.size_m);
  if (sizes_mm.size() == 1) return fmt::format("all of {:.4g} mm", *sizes_mm.begin());
  return fmt::format("of {:.4g} to {:.4g} mm", *sizes_mm.begin(), *sizes_mm.rbegin());
}

std::string map_in_short(const TagMap& map) {
  std::set<std::string> families;
  for (const MapTag& tag : map.tags) families.insert(tag.key.family);
  const auto known =
      std::ranges::count_if(map.tags, [](const MapTag& tag) { return tag.covariance.has_value(); });
  return fmt::format("{} {} of family {}, {}, in frame '{}'; {}.", map.tags.size(),
                     map.tags.size() == 1 ? "tag" : "tags", fmt::join(families, ", "), sizes_in_words(map),
                     map.frame,
                     known == 0 ? "the map says nothing of how well they are known"
                                : fmt::format("{} have a covariance", known));
}

HtmlTable table_of_map(const TagMap& map) {
  HtmlTable table{
      {"tag", "size, mm", "x, m", "y, m", "z, m", "faces", "sigma, mm", "sigma, \xC2\xB0", "views",
       "residual, px", "flags"},
      {},
      "Faces: the direction towards who looks at the print, in the map's frame. Sigma: root mean square "
      "length of the error that the covariance expects, relative to the map's gauge."};
  for (const MapTag& tag : map.tags) {
    const Eigen::Vector3d& p = tag.T_map_tag.translation();
    const Eigen::Vector3d faces = -(tag.T_map_tag.rotation() * Eigen::Vector3d::UnitZ());
    std::vector<std::string> row = {
        to_string(tag.key),           fmt::format("{:.4g}", 1e3 * tag.size_m),
        fmt::format("{:.4f}", p.x()), fmt::format("{:.4f}", p.y()),
        fmt::format("{:.4f}", p.z()), fmt::format("{:.2f}, {:.2f}, {:.2f}", faces.x(), faces.y(), faces.z())};
    if (tag.covariance) {
      row.push_back(fmt::format("{:.3f}", 1e3 * position_sigma_m(*tag.covariance)));
      row.push_back(fmt::format("{:.4f}", kDegPerRad * rotation_sigma_rad(*tag.covariance)));
    } else {
      row.insert(row.end(), 2, "-");
    }
    if (tag.statistics) {
      const std::vector<std::string>& flags = tag.statistics->flags;
      row.push_back(fmt::format("{}", tag.statistics->views));
      row.push_back(fmt::format("{:.3f}", tag.statistics->residual_rms_px));
      row.push_back(flags.empty() ? "-" : fmt::format("{}", fmt::join(flags, ", ")));
    } else {
      row.insert(row.end(), 3, "-");
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace

void write_map_report(const std::filesystem::path& path, const std::string& file, const TagMap& map) {
  const MapEvidence nothing_seen;
  const MapAssessment nothing_said;
  DrawnMap drawn{.map = map, .evidence = nothing_seen, .assessment = nothing_said};
  drawn.ellipse_scale = ellipse_scale_for({drawn});
  HtmlPage page(fmt::format("Tag map: {}", file));
  page.heading("In short");
  page.paragraph(map_in_short(map));
  page.scene(scene_of_map(map, up_of(drawn), drawn.ellipse_scale), caption_of_scene(drawn));
  const MapDrawing above = draw_from_above(drawn), sides = draw_from_sides(drawn);
  page.svg(above.pictures.front(), above.caption);
  page.svg(sides.pictures, sides.caption);
  page.heading("Tag by tag");
  page.table(table_of_map(map));
  if (!map.provenance.empty()) {
    HtmlTable origin{{"what", "value"}, {}, ""};
    for (const auto& [key, value] : map.provenance) origin.rows.push_back({key, value});
    page.heading("Where it comes from");
    page.table(origin);
  }
  write_html_page(path, page);
}

}  // namespace apriltrack::app
