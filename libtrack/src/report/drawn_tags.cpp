#include "apriltrack/report/drawn_tags.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "apriltrack/report/label_layout.h"
#include "apriltrack/report/lengths.h"
#include "apriltrack/report/map_scene.h"

namespace apriltrack {
namespace {

double grid_step_m(const PaperScale& scale) {
  const Eigen::Vector2d size = scale.high_m() - scale.low_m();
  return round_number_below(size.maxCoeff() / 4.0);
}

/// Points where the tag faces.
void draw_normal(const DrawnTag& drawn, const Elevation& elevation, const PaperScale& scale,
                 SvgPicture& picture) {
  const Eigen::Vector3d center = drawn.tag.T_map_tag.translation();
  const Eigen::Vector3d normal = -(drawn.tag.T_map_tag.rotation() * Eigen::Vector3d::UnitZ());
  const Eigen::Vector2d from = scale.at(elevation.of(center));
  const Eigen::Vector2d along = scale.at(elevation.of(Eigen::Vector3d(center + normal))) - from;
  const double length =
      std::clamp(0.9 * drawn.tag.size_m * scale.units_per_m(), 12.0, 26.0) / scale.units_per_m();
  picture.arrow(from, from + length * along, {.stroke = drawn.ink, .width = 1.2});
}

void draw_tag(const DrawnTag& drawn, const Elevation& elevation, const PaperScale& scale,
              SvgPicture& picture) {
  std::vector<Eigen::Vector2d> outline;
  for (const Eigen::Vector3d& corner : corners_in_map(drawn.tag))
    outline.push_back(scale.at(elevation.of(corner)));
  draw_normal(drawn, elevation, scale, picture);
  picture.polygon(outline, {.stroke = drawn.ink,
                            .width = 2.2,
                            .fill = drawn.fill,
                            .fill_opacity = 0.6,
                            .is_dashed = !drawn.takes_part,
                            .tooltip = drawn.tooltip.empty() ? tooltip_of(drawn.tag) : drawn.tooltip});
  if (!drawn.takes_part) picture.line(outline[0], outline[2], {.stroke = drawn.ink, .width = 1.4});
}

/// Behind the tag, where there is room.
void draw_names(const std::vector<DrawnTag>& tags, const Elevation& elevation, const PaperScale& scale,
                SvgPicture& picture) {
  constexpr double kLetters = 13.0;
  LabelLayout places(picture.width(), picture.height(), kLetters);
  for (const DrawnTag& drawn : tags) {
    for (const Eigen::Vector3d& corner : corners_in_map(drawn.tag)) {
      const Eigen::Vector3d halfway = 0.5 * (corner + drawn.tag.T_map_tag.translation());
      places.keep_clear(scale.at(elevation.of(halfway)), 0.25 * drawn.tag.size_m * scale.units_per_m());
    }
  }
  for (const DrawnTag& drawn : tags) {
    const Eigen::Vector3d into_tag = drawn.tag.T_map_tag.rotation() * Eigen::Vector3d::UnitZ();
    const Eigen::Vector2d behind(elevation.of(into_tag).x(), -elevation.of(into_tag).y());
    const Eigen::Vector2d at = scale.at(elevation.of(drawn.tag.T_map_tag.translation()));
    picture.text(places.place(at, behind, drawn.name), drawn.name,
                 {.size = kLetters,
                  .ink = drawn.ink,
                  .anchor = SvgAnchor::kMiddle,
                  .is_bold = true,
                  .has_halo = true});
  }
}

}  // namespace

std::string tooltip_of(const MapTag& tag) {
  return fmt::format("{}: {}", to_string(tag.key), fmt::join(notes_of(tag), "; "));
}

void draw_paper(const PaperScale& scale, SvgPicture& picture) {
  picture.rectangle({0.5, 0.5}, {scale.width() - 1.0, scale.height() - 1.0},
                    {.stroke = SvgInk::kRule, .fill = SvgInk::kTint, .fill_opacity = 0.5});
  const Eigen::Vector2d low = scale.low_m(), high = scale.high_m();
  const double step_m = grid_step_m(scale);
  const SvgStyle style{.stroke = SvgInk::kRule, .width = 0.8};
  for (double x = std::ceil(low.x() / step_m) * step_m; x < high.x(); x += step_m) {
    const double at = scale.at({x, 0.0}).x();
    picture.line({at, 0.0}, {at, scale.height()}, style);
  }
  for (double y = std::ceil(low.y() / step_m) * step_m; y < high.y(); y += step_m) {
    const double at = scale.at({0.0, y}).y();
    picture.line({0.0, at}, {scale.width(), at}, style);
  }
}

void draw_title_and_scale(const std::string& title, const PaperScale& scale, SvgPicture& picture) {
  picture.text({14.0, 22.0}, title, {.size = 14.0, .is_bold = true, .has_halo = true});
  const double step_m = grid_step_m(scale);
  const Eigen::Vector2d from(14.0, scale.height() - 14.0);
  const Eigen::Vector2d to = from + Eigen::Vector2d(step_m * scale.units_per_m(), 0.0);
  picture.line(from, to, {.stroke = SvgInk::kPale, .width = 2.0});
  for (const Eigen::Vector2d& end : {from, to})
    picture.line(end - Eigen::Vector2d(0.0, 4.0), end + Eigen::Vector2d(0.0, 4.0),
                 {.stroke = SvgInk::kPale, .width = 2.0});
  picture.text({to.x() + 7.0, to.y() + 4.0}, length_in_words(step_m),
               {.ink = SvgInk::kPale, .has_halo = true});
}

void draw_tags(const std::vector<DrawnTag>& tags, const Elevation& elevation, const PaperScale& scale,
               SvgPicture& picture) {
  for (const DrawnTag& drawn : tags) draw_tag(drawn, elevation, scale, picture);
  draw_names(tags, elevation, scale, picture);
}

}  // namespace apriltrack
