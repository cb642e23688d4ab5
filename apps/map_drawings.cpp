#include "map_drawings.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <set>

#include "apriltrack/base/degrees.h"
#include "label_places.h"
#include "map_projection.h"

namespace apriltrack::app {
namespace {

constexpr double kWidth = 1010.0, kMaxHeight = 820.0, kMargin = 64.0;
constexpr double kHalfWidth = 620.0, kHalfMaxHeight = 560.0, kHalfMargin = 52.0;
constexpr double kGap_s = 1.0;            // over which the path is not drawn
constexpr double kLargestEllipse = 46.0;  // half its length, in units of the picture

double sigma_of(const std::optional<Matrix6d>& covariance, bool is_rotation) {
  if (!covariance) return 0.0;
  return std::sqrt(is_rotation ? covariance->bottomRightCorner<3, 3>().trace()
                               : covariance->topLeftCorner<3, 3>().trace());
}

std::string name_on_paper(const TagMap& map, const MapTag& tag) {
  const bool is_one_family = std::ranges::all_of(
      map.tags, [&](const MapTag& other) { return other.key.family == map.tags.front().key.family; });
  return is_one_family ? fmt::format("{}", tag.key.id) : to_string(tag.key);
}

std::string tooltip_of(const MapTag& tag) {
  std::string text = to_string(tag.key);
  if (tag.statistics) text += fmt::format(": {} views", tag.statistics->views);
  if (tag.covariance)
    text += fmt::format(", sigma {:.2f} mm and {:.3f} degrees", 1e3 * sigma_of(tag.covariance, false),
                        kDegPerRad * sigma_of(tag.covariance, true));
  return text;
}

/// The position's covariance in the map's frame.
Eigen::Matrix3d position_covariance(const MapTag& tag) {
  const Eigen::Matrix3d R = tag.T_map_tag.rotation_matrix();
  return R * tag.covariance->topLeftCorner<3, 3>() * R.transpose();
}

bool is_held(const MapTag& tag) {
  return tag.covariance && tag.covariance->isZero();
}

bool is_doubtful(const DrawnMap& drawn, const MapTag& tag) {
  const auto& directions = drawn.assessment.directions;
  const auto own = std::ranges::find(directions, tag.key, &WeakDirection::tag);
  return (tag.statistics && !tag.statistics->flags.empty()) || (own != directions.end() && own->is_weak);
}

std::vector<Eigen::Vector2d> all_points(const DrawnMap& drawn, const Elevation& elevation) {
  std::vector<Eigen::Vector2d> points;
  for (const MapTag& tag : drawn.map.tags) {
    for (const Eigen::Vector3d& corner : corners_in_map(tag)) points.push_back(elevation.of(corner));
  }
  for (const RigPose& moment : drawn.evidence.moments)
    points.push_back(elevation.of(moment.T_map_rig.translation()));
  return points;
}

/// By how much ellipses are drawn too large, so that they are seen: a round number.
double exaggeration(const DrawnMap& drawn, double units_per_m) {
  double largest_m = 0.0;
  for (const MapTag& tag : drawn.map.tags) largest_m = std::max(largest_m, sigma_of(tag.covariance, false));
  if (!(largest_m > 0.0)) return 1.0;
  return std::max(1.0, round_number_below(kLargestEllipse / (largest_m * units_per_m)));
}

/// Lines a round number of metres apart; tells how many.
double draw_grid(const PaperScale& scale, SvgPicture& picture) {
  const Eigen::Vector2d low = scale.low_m(), high = scale.high_m();
  const double step_m = round_number_below(std::max(high.x() - low.x(), high.y() - low.y()) / 4.0);
  const SvgStyle style{.stroke = SvgInk::kRule, .width = 0.8};
  for (double x = std::ceil(low.x() / step_m) * step_m; x < high.x(); x += step_m) {
    const double at = scale.at({x, 0.0}).x();
    picture.line({at, 0.0}, {at, scale.height()}, style);
  }
  for (double y = std::ceil(low.y() / step_m) * step_m; y < high.y(); y += step_m) {
    const double at = scale.at({0.0, y}).y();
    picture.line({0.0, at}, {scale.width(), at}, style);
  }
  return step_m;
}

void draw_scale_bar(const PaperScale& scale, double step_m, SvgPicture& picture) {
  const Eigen::Vector2d from(14.0, scale.height() - 14.0);
  const Eigen::Vector2d to = from + Eigen::Vector2d(step_m * scale.units_per_m(), 0.0);
  picture.line(from, to, {.stroke = SvgInk::kPale, .width = 2.0});
  for (const Eigen::Vector2d& end : {from, to})
    picture.line(end - Eigen::Vector2d(0.0, 4.0), end + Eigen::Vector2d(0.0, 4.0),
                 {.stroke = SvgInk::kPale, .width = 2.0});
  picture.text({to.x() + 7.0, to.y() + 4.0}, fmt::format("{:g} m", step_m),
               {.ink = SvgInk::kPale, .has_halo = true});
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

void draw_ellipse(const MapTag& tag, const Elevation& elevation, const PaperScale& scale, double factor,
                  SvgPicture& picture) {
  if (!tag.covariance || is_held(tag)) return;
  const double units = factor * scale.units_per_m();
  Eigen::Matrix2d covariance = units * units * elevation.of(position_covariance(tag));
  covariance(0, 1) = covariance(1, 0) = -covariance(0, 1);  // y down
  picture.ellipse(scale.at(elevation.of(tag.T_map_tag.translation())), covariance,
                  {.stroke = SvgInk::kAccent,
                   .width = 1.0,
                   .fill = SvgInk::kAccent,
                   .fill_opacity = 0.14,
                   .tooltip = tooltip_of(tag)});
}

void draw_tag(const DrawnMap& drawn, const MapTag& tag, const Elevation& elevation, const PaperScale& scale,
              SvgPicture& picture) {
  const SvgInk ink = is_doubtful(drawn, tag) ? SvgInk::kWarning : SvgInk::kText;
  std::vector<Eigen::Vector2d> outline;
  for (const Eigen::Vector3d& corner : corners_in_map(tag)) outline.push_back(scale.at(elevation.of(corner)));
  const Eigen::Vector3d normal = -(tag.T_map_tag.rotation() * Eigen::Vector3d::UnitZ());
  const Eigen::Vector3d center = tag.T_map_tag.translation();
  const Eigen::Vector2d from = scale.at(elevation.of(center));
  const Eigen::Vector2d along = scale.at(elevation.of(Eigen::Vector3d(center + normal))) - from;
  const double arrow = std::clamp(0.9 * tag.size_m * scale.units_per_m(), 12.0, 26.0) / scale.units_per_m();
  picture.arrow(from, from + arrow * along, {.stroke = ink, .width = 1.2});
  picture.polygon(outline, {.stroke = ink,
                            .width = 2.4,
                            .fill = is_held(tag) ? SvgInk::kGood : SvgInk::kPaper,
                            .fill_opacity = 0.6,
                            .tooltip = tooltip_of(tag)});
}

/// Behind the tag, where there is room.
void draw_names(const DrawnMap& drawn, const Elevation& elevation, const PaperScale& scale,
                SvgPicture& picture) {
  constexpr double kLetters = 13.0;
  LabelPlaces places(picture.width(), picture.height(), kLetters);
  for (const MapTag& tag : drawn.map.tags) {
    for (const Eigen::Vector3d& corner : corners_in_map(tag)) {
      const Eigen::Vector3d halfway = 0.5 * (corner + tag.T_map_tag.translation());
      places.keep_clear(scale.at(elevation.of(halfway)), 0.25 * tag.size_m * scale.units_per_m());
    }
  }
  for (const MapTag& tag : drawn.map.tags) {
    const Eigen::Vector3d into_tag = tag.T_map_tag.rotation() * Eigen::Vector3d::UnitZ();
    const Eigen::Vector2d behind(elevation.of(into_tag).x(), -elevation.of(into_tag).y());
    const std::string name = name_on_paper(drawn.map, tag);
    picture.text(places.place(scale.at(elevation.of(tag.T_map_tag.translation())), behind, name), name,
                 {.size = kLetters,
                  .ink = is_doubtful(drawn, tag) ? SvgInk::kWarning : SvgInk::kText,
                  .anchor = SvgAnchor::kMiddle,
                  .is_bold = true,
                  .has_halo = true});
  }
}

struct Drawn {
  SvgPicture picture;
  double factor = 1.0;  ///< Of ellipses.
};

Drawn draw(const DrawnMap& drawn, const Elevation& elevation, const PaperScale& scale, double factor) {
  SvgPicture picture(scale.width(), scale.height());
  picture.rectangle({0.5, 0.5}, {scale.width() - 1.0, scale.height() - 1.0},
                    {.stroke = SvgInk::kRule, .fill = SvgInk::kTint, .fill_opacity = 0.5});
  const double step_m = draw_grid(scale, picture);
  draw_camera_path(drawn, elevation, scale, picture);
  for (const MapTag& tag : drawn.map.tags) draw_ellipse(tag, elevation, scale, factor, picture);
  for (const MapTag& tag : drawn.map.tags) draw_tag(drawn, tag, elevation, scale, picture);
  draw_names(drawn, elevation, scale, picture);
  picture.text({14.0, 22.0}, elevation.name, {.size = 14.0, .is_bold = true, .has_halo = true});
  draw_scale_bar(scale, step_m, picture);
  return {std::move(picture), factor};
}

std::string caption_of(const DrawnMap& drawn, double factor) {
  std::string ellipses = "The map has no covariances, and so no ellipses.";
  if (std::ranges::any_of(drawn.map.tags, [](const MapTag& tag) { return tag.covariance.has_value(); }))
    ellipses =
        fmt::format("Ellipses: one sigma of the position relative to the {}, drawn {:g} times too large.",
                    drawn.is_frame_measured ? "measured frame" : "held tag", factor);
  return fmt::format(
      "Tags with the direction they face; {}doubtful ones in orange. {} The line is the camera's path. Up is "
      "{}.",
      drawn.is_frame_measured ? "" : "the held one filled in green, ", ellipses,
      drawn.is_vertical_measured ? "z of the map, as measured" : "as the camera was held");
}

Elevations elevations_of(const DrawnMap& drawn) {
  return app::elevations_of(
      drawn.map, drawn.is_vertical_measured ? Eigen::Vector3d::UnitZ() : upward(drawn.map, drawn.evidence));
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

MapDrawing draw_from_above(const DrawnMap& drawn) {
  const Elevation elevation = elevations_of(drawn).above;
  const PaperScale scale(all_points(drawn, elevation), kWidth, kMaxHeight, kMargin);
  const double factor = exaggeration(drawn, scale.units_per_m());
  return {{draw(drawn, elevation, scale, factor).picture}, caption_of(drawn, factor)};
}

MapDrawing draw_from_sides(const DrawnMap& drawn) {
  const Elevations elevations = elevations_of(drawn);
  std::vector<PaperScale> scales;
  double factor = std::numeric_limits<double>::infinity();
  for (const Elevation& one : {elevations.front, elevations.side}) {
    scales.emplace_back(all_points(drawn, one), kHalfWidth, kHalfMaxHeight, kHalfMargin);
    factor = std::min(factor, exaggeration(drawn, scales.back().units_per_m()));
  }
  return {{draw(drawn, elevations.front, scales[0], factor).picture,
           draw(drawn, elevations.side, scales[1], factor).picture},
          fmt::format("The same from two sides; ellipses {:g} times too large.", factor)};
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
