#include "chart_svg_series.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <set>
#include <utility>
#include <vector>

#include "svg_inks.h"

namespace apriltrack {
namespace {

constexpr double kSvgLine = 1.4;
constexpr double kColumn = 0.5;  // units of the drawing; what is narrower cannot be seen

Eigen::Vector2d to_eigen(cv::Point2d point) {
  return {point.x, point.y};
}

bool is_missing(const ChartSeries& series, std::size_t i) {
  return std::isnan(series.x[i]) || std::isnan(series.y[i]);
}

/// Parts of a series between gaps: the first number, and the one behind the last.
std::vector<std::pair<std::size_t, std::size_t>> runs_of(const ChartSeries& series) {
  std::vector<std::pair<std::size_t, std::size_t>> runs;
  for (std::size_t i = 0; i < series.x.size(); ++i) {
    if (is_missing(series, i)) continue;
    const std::size_t first = i;
    while (i < series.x.size() && !is_missing(series, i)) ++i;
    runs.emplace_back(first, i);
  }
  return runs;
}

/// Of points in one column the first, the highest, the lowest and the last: they look the same.
std::vector<cv::Point2d> thinned(const std::vector<cv::Point2d>& points) {
  std::vector<cv::Point2d> kept;
  for (std::size_t first = 0; first < points.size();) {
    const double column = std::floor(points[first].x / kColumn);
    std::size_t end = first + 1;
    while (end < points.size() && std::floor(points[end].x / kColumn) == column) ++end;
    if (end - first <= 4) {
      kept.insert(kept.end(), points.begin() + static_cast<std::ptrdiff_t>(first),
                  points.begin() + static_cast<std::ptrdiff_t>(end));
    } else {
      const auto begin = points.begin() + static_cast<std::ptrdiff_t>(first);
      const auto [high, low] = std::ranges::minmax_element(
          begin, points.begin() + static_cast<std::ptrdiff_t>(end), {}, &cv::Point2d::y);
      const std::set<std::ptrdiff_t> some = {0, high - begin, low - begin,
                                             static_cast<std::ptrdiff_t>(end - first) - 1};
      for (const std::ptrdiff_t i : some) kept.push_back(begin[i]);
    }
    first = end;
  }
  return kept;
}

/// What of a line lies in the box, as lines without a break.
std::vector<std::vector<Eigen::Vector2d>> clipped_lines(const std::vector<cv::Point2d>& points,
                                                        const PlotArea& area) {
  std::vector<std::vector<Eigen::Vector2d>> lines;
  bool is_open = false;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const auto part = area.clipped(points[i - 1], points[i]);
    if (!part) {
      is_open = false;
      continue;
    }
    if (!is_open || part->first != points[i - 1]) lines.push_back({to_eigen(part->first)});
    lines.back().push_back(to_eigen(part->second));
    is_open = part->second == points[i];
  }
  return lines;
}

void draw_svg_lines(const ChartSeries& series, const PlotArea& area, SvgPicture& picture) {
  const SvgStyle style{.stroke = ink_of(series.colour), .width = kSvgLine};
  std::vector<Eigen::Vector2d> alone;  // between two gaps there is no line to be seen
  for (const auto& [first, end] : runs_of(series)) {
    std::vector<cv::Point2d> points;
    for (std::size_t i = first; i < end; ++i) points.push_back(area.place(series.x[i], series.y[i]));
    if (points.size() == 1 && area.held(points.front()) == points.front())
      alone.push_back(to_eigen(points.front()));
    for (const auto& line : clipped_lines(thinned(points), area)) picture.polyline(line, style);
  }
  SvgStyle of_dots = style;
  of_dots.width = 3.0;
  picture.dots(alone, of_dots);
}

/// Points held at the edge of the box; each place once.
std::vector<Eigen::Vector2d> distinct_places(const ChartSeries& series, const PlotArea& area) {
  constexpr std::size_t kVeryMany = 3000;
  const double grain = series.x.size() > kVeryMany ? 1.8 : 0.75;  // half a dot, or less
  std::set<std::pair<long, long>> taken;
  std::vector<Eigen::Vector2d> places;
  for (std::size_t i = 0; i < series.x.size(); ++i) {
    if (is_missing(series, i)) continue;
    const cv::Point2d at = area.held(area.place(series.x[i], series.y[i]));
    if (taken.emplace(std::lround(at.x / grain), std::lround(at.y / grain)).second)
      places.push_back(to_eigen(at));
  }
  return places;
}

void draw_svg_cross(const Eigen::Vector2d& at, const SvgStyle& style, SvgPicture& picture) {
  constexpr double kHalf = 3.2;
  picture.line(at - Eigen::Vector2d(kHalf, kHalf), at + Eigen::Vector2d(kHalf, kHalf), style);
  picture.line(at - Eigen::Vector2d(kHalf, -kHalf), at + Eigen::Vector2d(kHalf, -kHalf), style);
}

void draw_svg_points(const ChartSeries& series, const std::vector<Eigen::Vector2d>& places,
                     SvgPicture& picture) {
  constexpr std::size_t kMany = 1000;
  const SvgInk ink = ink_of(series.colour);
  const SvgStyle thin{.stroke = ink, .width = 1.1, .opacity = series.opacity};
  if (series.mark == ChartMark::kRings) {
    for (const Eigen::Vector2d& place : places) picture.circle(place, 3.2, thin);
  } else if (series.mark == ChartMark::kCrosses) {
    for (const Eigen::Vector2d& place : places) draw_svg_cross(place, thin, picture);
  } else {
    picture.dots(places,
                 {.stroke = ink, .width = series.x.size() > kMany ? 3.6 : 5.0, .opacity = series.opacity});
  }
}

}  // namespace

bool has_anything_to_draw(const ChartSeries& series) {
  for (std::size_t i = 0; i < series.x.size(); ++i)
    if (!is_missing(series, i)) return true;
  return false;
}

void draw_svg_band(const ChartSeries& series, const PlotArea& area, SvgPicture& picture) {
  if (series.half_width.empty()) return;
  ChartSeries known = series;  // where the width is not known is a gap, too
  for (std::size_t i = 0; i < known.x.size(); ++i)
    if (std::isnan(known.half_width[i])) known.y[i] = known.half_width[i];
  for (const auto& [first, end] : runs_of(known)) {
    std::vector<cv::Point2d> upper, lower;
    for (std::size_t i = first; i < end; ++i) {
      upper.push_back(area.held(area.place(known.x[i], known.y[i] + known.half_width[i])));
      lower.push_back(area.held(area.place(known.x[i], known.y[i] - known.half_width[i])));
    }
    std::vector<Eigen::Vector2d> outline;
    for (const cv::Point2d& point : thinned(upper)) outline.push_back(to_eigen(point));
    const std::vector<cv::Point2d> back = thinned(lower);
    for (auto point = back.rbegin(); point != back.rend(); ++point) outline.push_back(to_eigen(*point));
    picture.polygon(outline, {.stroke = SvgInk::kNone, .fill = ink_of(series.colour), .fill_opacity = 0.22});
  }
}

void draw_svg_series(const ChartSeries& series, const PlotArea& area, SvgPicture& picture) {
  if (series.mark == ChartMark::kLine || series.mark == ChartMark::kLineAndPoints)
    draw_svg_lines(series, area, picture);
  if (series.mark != ChartMark::kLine) draw_svg_points(series, distinct_places(series, area), picture);
}

void draw_svg_mark(const ChartSeries& series, const Eigen::Vector2d& left, const Eigen::Vector2d& right,
                   SvgPicture& picture) {
  if (series.mark == ChartMark::kLine || series.mark == ChartMark::kLineAndPoints)
    picture.line(left, right, {.stroke = ink_of(series.colour), .width = 2.4});
  if (series.mark != ChartMark::kLine) draw_svg_points(series, {0.5 * (left + right)}, picture);
}

}  // namespace apriltrack
