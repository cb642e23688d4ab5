#include "map_drawings.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <set>

#include "apriltrack/report/drawn_tags.h"
#include "apriltrack/report/label_layout.h"
#include "apriltrack/report/map_elevation.h"
#include "apriltrack/report/map_scene.h"
#include "upward.h"

namespace apriltrack::app {
namespace {

constexpr double kWidth = 1010.0, kMaxHeight = 820.0, kMargin = 64.0;
constexpr double kHalfWidth = 620.0, kHalfMaxHeight = 560.0, kHalfMargin = 52.0;
constexpr double kGap_s = 1.0;            // over which the path is not drawn
constexpr double kLargestEllipse = 46.0;  // half its length, in units of the picture

std::vector<Eigen::Vector2d> all_points(const DrawnMap& drawn, const Elevation& elevation) {
  std::vector<Eigen::Vector2d> points;
  for (const MapTag& tag : drawn.map.tags) {
    for (const Eigen::Vector3d& corner : corners_in_map(tag)) points.push_back(elevation.of(corner));
  }
  for (const MapTag& tag : drawn.left_out) {
    for (const Eigen::Vector3d& corner : corners_in_map(tag)) points.push_back(elevation.of(corner));
  }
  for (const RigPose& moment : drawn.evidence.moments)
    points.push_back(elevation.of(moment.T_map_rig.translation()));
  return points;
}

void draw_camera_path(const DrawnMap& drawn, const Elevation& elevation, const PaperScale& scale,
                      SvgPicture& picture) {
  std::vector<Eigen::Vector2d> line;
  const SvgStyle style{.stroke = SvgInk::kPath, .width = 1.3, .opacity = 0.75};
  const auto& moments = drawn.evidence.moments;
  for (std::size_t i = 0; i < moments.size(); ++i) {
    if (i > 0 && seconds_between(moments[i - 1].timestamp, moments[i].timestamp) > kGap_s) {
      picture.polyline(line, style);
      line.clear();
    }
    line.push_back(scale.at(elevation.of(moments[i].T_map_rig.translation())));
  }
  picture.polyline(line, style);
}

void draw_ellipse(const DrawnMap& drawn, const MapTag& tag, const Elevation& elevation,
                  const PaperScale& scale, SvgPicture& picture) {
  if (!tag.covariance || is_held(tag)) return;
  const double units = drawn.ellipse_scale * scale.units_per_m();
  Eigen::Matrix2d covariance = units * units * elevation.of(position_covariance(tag));
  covariance(0, 1) = covariance(1, 0) = -covariance(0, 1);  // y down
  picture.ellipse(scale.at(elevation.of(tag.T_map_tag.translation())), covariance,
                  {.stroke = SvgInk::kAccent, .width = 1.0, .fill = SvgInk::kAccent, .fill_opacity = 0.14});
}

std::vector<DrawnTag> drawn_tags(const DrawnMap& drawn) {
  std::vector<DrawnTag> tags;
  for (const MapTag& tag : drawn.left_out)
    tags.push_back(
        {.tag = tag, .name = short_name(drawn.map, tag), .ink = SvgInk::kPurpleInk, .takes_part = false});
  for (const MapTag& tag : drawn.map.tags)
    tags.push_back({.tag = tag,
                    .name = short_name(drawn.map, tag),
                    .ink = is_doubtful(drawn, tag) ? SvgInk::kWarning : SvgInk::kText,
                    .fill = is_held(tag) ? SvgInk::kGood : SvgInk::kPaper});
  return tags;
}

SvgPicture draw(const DrawnMap& drawn, const Elevation& elevation, const PaperScale& scale) {
  SvgPicture picture(scale.width(), scale.height());
  draw_paper(scale, picture);
  draw_camera_path(drawn, elevation, scale, picture);
  for (const MapTag& tag : drawn.map.tags) draw_ellipse(drawn, tag, elevation, scale, picture);
  draw_tags(drawn_tags(drawn), elevation, scale, picture);
  draw_title_and_scale(elevation.name, scale, picture);
  return picture;
}

std::string about_ellipses(const DrawnMap& drawn) {
  if (std::ranges::none_of(drawn.map.tags, [](const MapTag& tag) { return tag.covariance.has_value(); }))
    return "The map has no covariances, and so no ellipses.";
  return fmt::format("Ellipses: one sigma of the position relative to the {}, drawn {:g} times too large.",
                     drawn.is_frame_measured ? "measured frame" : "held tag", drawn.ellipse_scale);
}

std::string about_path(const DrawnMap& drawn) {
  if (drawn.is_vertical_measured) return "Up is z of the map, as measured.";
  return drawn.evidence.moments.empty() ? "Up is as most tags hang." : "Up is as the camera was held.";
}

std::string caption_of(const DrawnMap& drawn) {
  std::string text = fmt::format("Tags with the direction they face; {}doubtful ones in orange.",
                                 drawn.is_frame_measured ? "" : "the held one filled in green, ");
  if (!drawn.left_out.empty())
    text += " Dashed and crossed: left out of the map, drawn where most of their own views put them.";
  text += " " + about_ellipses(drawn);
  if (!drawn.evidence.moments.empty()) text += " The line is the camera's path.";
  return text + " " + about_path(drawn);
}

Elevations elevations_of(const DrawnMap& drawn) {
  return apriltrack::elevations_of(drawn.map, up_of(drawn));
}

PaperScale scale_from_above(const DrawnMap& drawn) {
  return {all_points(drawn, elevations_of(drawn).above), kWidth, kMaxHeight, kMargin};
}

SvgStyle style_of_link(const SeenTogether& link) {
  const double width = std::min(7.0, 0.5 + 0.75 * std::log2(1.0 + link.frames));
  return {.stroke = link.is_bridge ? SvgInk::kWarning : SvgInk::kAccent,
          .width = link.is_bridge ? std::max(2.0, width) : width,
          .opacity = link.is_bridge ? 0.9 : 0.28,
          .tooltip = fmt::format("{} {}", link.frames, link.frames == 1 ? "frame" : "frames")};
}

constexpr double kNodeRadius = 13.0;

/// Where tags stand in the picture of what is seen together.
struct LinkLayout {
  double width, height;
  std::vector<Eigen::Vector2d> nodes;  ///< In the order of the map.
  bool are_named;                      ///< There is room for their ids.
};

/// As from above, pushed apart where they have names.
LinkLayout lay_out_links(const DrawnMap& drawn) {
  constexpr std::size_t kMostNamed = 120;
  const Elevation elevation = elevations_of(drawn).above;
  std::vector<Eigen::Vector2d> places_m;
  for (const MapTag& tag : drawn.map.tags) places_m.push_back(elevation.of(tag.T_map_tag.translation()));
  const PaperScale scale(places_m, kWidth, 0.8 * kMaxHeight, 0.8 * kMargin);
  LinkLayout layout{scale.width(), scale.height(), {}, places_m.size() <= kMostNamed};
  for (const Eigen::Vector2d& place : places_m) layout.nodes.push_back(scale.at(place));
  constexpr double kEdge = kNodeRadius + 2.0;
  if (layout.are_named)
    push_apart(layout.nodes, 2.3 * kNodeRadius, {kEdge, kEdge},
               {layout.width - kEdge, layout.height - kEdge});
  return layout;
}

void draw_link_lines(const DrawnMap& drawn, const LinkLayout& layout, bool are_bridges, SvgPicture& picture) {
  for (const SeenTogether& link : drawn.assessment.links) {
    if (link.is_bridge != are_bridges) continue;
    const Eigen::Vector2d &a = layout.nodes[static_cast<std::size_t>(link.tag_a)],
                          &b = layout.nodes[static_cast<std::size_t>(link.tag_b)];
    picture.line(a, b, style_of_link(link));
    if (are_bridges)
      picture.text(
          0.5 * (a + b) - Eigen::Vector2d(0.0, 5.0), fmt::format("{}", link.frames),
          {.ink = SvgInk::kWarning, .anchor = SvgAnchor::kMiddle, .is_bold = true, .has_halo = true});
  }
}

void draw_node(const DrawnMap& drawn, const LinkLayout& layout, std::size_t i, SvgPicture& picture) {
  const MapTag& tag = drawn.map.tags[i];
  picture.circle(layout.nodes[i], layout.are_named ? kNodeRadius : 4.0,
                 {.stroke = is_doubtful(drawn, tag) ? SvgInk::kWarning : SvgInk::kText,
                  .width = 1.4,
                  .fill = is_held(tag) ? SvgInk::kGood : SvgInk::kPaper,
                  .tooltip = tooltip_of(tag)});
  if (!layout.are_named) return;
  picture.text(layout.nodes[i] + Eigen::Vector2d(0.0, 4.0), fmt::format("{}", tag.key.id),
               {.size = 12.0,
                .ink = is_held(tag) ? SvgInk::kPaper : SvgInk::kText,
                .anchor = SvgAnchor::kMiddle,
                .is_bold = true});
}

}  // namespace

double ellipse_scale_for(const std::vector<DrawnMap>& all) {
  double longest = 0.0;  // units of the drawing
  for (const DrawnMap& drawn : all) {
    double largest_m = 0.0;
    for (const MapTag& tag : drawn.map.tags)
      if (tag.covariance) largest_m = std::max(largest_m, position_sigma_m(*tag.covariance));
    longest = std::max(longest, largest_m * scale_from_above(drawn).units_per_m());
  }
  return longest > 0.0 ? std::max(1.0, round_number_below(kLargestEllipse / longest)) : 1.0;
}

Eigen::Vector3d up_of(const DrawnMap& drawn) {
  return drawn.is_vertical_measured ? Eigen::Vector3d::UnitZ() : upward(drawn.map, drawn.evidence);
}

bool is_doubtful(const DrawnMap& drawn, const MapTag& tag) {
  const auto& directions = drawn.assessment.directions;
  const auto own = std::ranges::find(directions, tag.key, &WeakDirection::tag);
  return (tag.statistics && !tag.statistics->flags.empty()) || (own != directions.end() && own->is_weak);
}

MapDrawing draw_from_above(const DrawnMap& drawn) {
  return {{draw(drawn, elevations_of(drawn).above, scale_from_above(drawn))}, caption_of(drawn)};
}

MapDrawing draw_from_sides(const DrawnMap& drawn) {
  const Elevations elevations = elevations_of(drawn);
  MapDrawing drawing;
  for (const Elevation& one : {elevations.front, elevations.side})
    drawing.pictures.push_back(
        draw(drawn, one, {all_points(drawn, one), kHalfWidth, kHalfMaxHeight, kHalfMargin}));
  drawing.caption = "The same from two sides.";
  return drawing;
}

MapDrawing draw_links(const DrawnMap& drawn) {
  const LinkLayout layout = lay_out_links(drawn);
  SvgPicture picture(layout.width, layout.height);
  draw_link_lines(drawn, layout, false, picture);
  draw_link_lines(drawn, layout, true, picture);
  for (std::size_t i = 0; i < layout.nodes.size(); ++i) draw_node(drawn, layout, i, picture);
  return {{std::move(picture)},
          "Which tags are seen together, laid out as from above: the more frames, the wider the line. In "
          "orange, with their number of frames, what ties a part to the rest by four frames or less."};
}

}  // namespace apriltrack::app
