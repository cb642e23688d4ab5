#include "chart_series.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <opencv2/imgproc.hpp>

namespace apriltrack {
namespace {

constexpr double kLevelNameHeight = 9.0;

/// By shade: 256 rows of one pixel.
cv::Mat shade_table() {
  cv::Mat numbers(256, 1, CV_8UC1);
  for (int i = 0; i < 256; ++i) numbers.at<std::uint8_t>(i) = static_cast<std::uint8_t>(255 - i);
  cv::Mat colours;
  cv::applyColorMap(numbers, colours, cv::COLORMAP_VIRIDIS);
  return colours;
}

bool is_gap(const ChartSeries& series, std::size_t i) {
  return std::isnan(series.x[i]) || std::isnan(series.y[i]);
}

/// A number between two gaps has no line to lie on, and would not be seen.
bool is_alone(const ChartSeries& series, std::size_t i) {
  return (i == 0 || is_gap(series, i - 1)) && (i + 1 == series.x.size() || is_gap(series, i + 1));
}

void draw_line(Canvas& canvas, const ChartSeries& series, const PlotArea& area) {
  const cv::Scalar colour = bgr_of(series.colour);
  for (std::size_t i = 0; i < series.x.size(); ++i) {
    if (is_gap(series, i)) continue;
    const cv::Point2d here = area.place(series.x[i], series.y[i]);
    const bool is_joined = i > 0 && !is_gap(series, i - 1);
    const cv::Point2d from = is_joined ? area.place(series.x[i - 1], series.y[i - 1]) : here;
    const auto part = area.clipped(from, here);
    if (part && is_joined) canvas.line(part->first, part->second, colour, kLineWidth);
    if (part && is_alone(series, i)) canvas.disc(here, 1.5 * kLineWidth, colour);
  }
}

/// Column by column from one point to the next; a point of its own is one column.
void draw_band_between(Canvas& canvas, const ChartSeries& series, const PlotArea& area, std::size_t from,
                       std::size_t to) {
  const auto held_place = [&](std::size_t i, double sign) {
    return area.held(area.place(series.x[i], series.y[i] + sign * series.half_width[i]));
  };
  if (std::isnan(series.half_width[from]) || std::isnan(series.half_width[to])) return;
  const cv::Point2d high_from = held_place(from, 1.0), high_to = held_place(to, 1.0);
  const cv::Point2d low_from = held_place(from, -1.0), low_to = held_place(to, -1.0);
  const double width = high_to.x - high_from.x;
  const int columns = std::max(1, static_cast<int>(std::ceil(width)));
  for (int column = 0; column < columns; ++column) {
    const double part = (column + 0.5) / columns;
    const double top = high_from.y + part * (high_to.y - high_from.y);
    const double bottom = low_from.y + part * (low_to.y - low_from.y);
    canvas.box({high_from.x + column * width / columns, top, std::max(1.0, width / columns), bottom - top},
               bgr_of(series.colour));
  }
}

double point_radius(std::size_t count) {
  return count > 1000 ? 2.2 : 3.0;
}

void draw_points(Canvas& canvas, const ChartSeries& series, const PlotArea& area) {
  std::vector<std::size_t> order(series.x.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  if (!series.shade.empty())
    std::ranges::stable_sort(order, {}, [&](std::size_t i) { return series.shade[i]; });
  for (const std::size_t i : order) {
    if (is_gap(series, i)) continue;
    const cv::Scalar colour = series.shade.empty() ? bgr_of(series.colour) : shade_colour(series.shade[i]);
    draw_mark(canvas, series, area.held(area.place(series.x[i], series.y[i])), point_radius(order.size()),
              colour);
  }
}

bool is_shown(const ChartLevel& level, const PlotArea& area) {
  const double part = area.y.fraction(level.y);
  return part >= 0.0 && part <= 1.0 && !(area.y.is_logarithmic && level.y <= 0.0);
}

void draw_dashes(Canvas& canvas, double y, cv::Rect2d box) {
  constexpr double kDash = 6.0;
  constexpr double kGap = 5.0;
  for (double x = box.x; x < box.br().x; x += kDash + kGap)
    canvas.box({x, y - 0.5, std::min(kDash, box.br().x - x), 1.0}, kInk);
}

}  // namespace

cv::Scalar shade_colour(double shade) {
  static const cv::Mat table = shade_table();
  const auto& colour = table.at<cv::Vec3b>(cvRound(255.0 * shade));
  return {static_cast<double>(colour[0]), static_cast<double>(colour[1]), static_cast<double>(colour[2])};
}

void draw_mark(Canvas& canvas, const ChartSeries& series, cv::Point2d at, double radius,
               const cv::Scalar& colour) {
  if (series.mark == ChartMark::kRings && series.shade.empty()) {
    canvas.ring(at, radius + 0.5, colour, 1.0);
  } else if (series.mark == ChartMark::kCrosses && series.shade.empty()) {
    canvas.line(at - cv::Point2d(radius, radius), at + cv::Point2d(radius, radius), colour);
    canvas.line(at - cv::Point2d(radius, -radius), at + cv::Point2d(radius, -radius), colour);
  } else {
    canvas.disc(at, radius, colour, series.opacity);
  }
}

bool draws_points(const ChartSeries& series) {
  return series.mark != ChartMark::kLine || !series.shade.empty();
}

bool draws_line(const ChartSeries& series) {
  return series.mark == ChartMark::kLineAndPoints ||
         (series.mark == ChartMark::kLine && series.shade.empty());
}

void draw_band(Canvas& canvas, const ChartSeries& series, const PlotArea& area) {
  if (series.half_width.empty()) return;
  constexpr double kOpacity = 0.25;  // it lies on the bands, and behind the lines, of others
  canvas.translucent(kOpacity, [&] {
    for (std::size_t i = 0; i < series.x.size(); ++i) {
      if (is_gap(series, i)) continue;
      const bool is_joined = i > 0 && !is_gap(series, i - 1);
      draw_band_between(canvas, series, area, is_joined ? i - 1 : i, i);
    }
  });
}

void draw_series(Canvas& canvas, const ChartSeries& series, const PlotArea& area) {
  if (draws_line(series)) draw_line(canvas, series, area);
  if (draws_points(series)) draw_points(canvas, series, area);
}

void draw_levels(Canvas& canvas, const std::vector<ChartLevel>& levels, const PlotArea& area) {
  constexpr double kLetters = kLevelNameHeight + 5.0;
  std::vector<ChartLevel> shown;
  std::ranges::copy_if(levels, std::back_inserter(shown),
                       [&](const ChartLevel& level) { return is_shown(level, area); });
  std::ranges::sort(shown, {}, &ChartLevel::y);
  for (const ChartLevel& level : shown) draw_dashes(canvas, area.place_y(level.y), area.box);
  double ceiling = area.box.br().y + kLetters;  // names go upwards, each above the one before
  for (const ChartLevel& level : shown) {
    const double line = area.place_y(level.y);
    const bool has_room = line - kLetters > area.box.y;
    const double base = std::min(has_room ? line - 5.0 : line + kLetters, ceiling - kLetters);
    canvas.text(Canvas::fitted(level.name, kLevelNameHeight, 0.5 * area.box.width),
                {area.box.br().x - 8.0, base}, kLevelNameHeight, kInk, Align::kRight, 2.0);
    ceiling = base;
  }
}

}  // namespace apriltrack
