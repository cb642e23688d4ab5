#include "apriltrack/report/chart.h"

#include <algorithm>

#include "apriltrack/io/atomic_file.h"
#include "canvas.h"
#include "chart_layout.h"
#include "chart_legend.h"
#include "chart_series.h"

namespace apriltrack {
namespace {

// Layout in points.
constexpr double kMargin = 60.0;
constexpr double kTitleLine = 42.0;
constexpr double kLegendLine = 74.0;
constexpr double kAxisNameGap = 46.0;  // from the legend to the plot
constexpr double kFootHeight = 68.0;
constexpr double kShadeBarSpace = 76.0;
constexpr double kNameHeight = 10.0;
constexpr double kTickHeight = 9.0;

void draw_grid(Canvas& canvas, const PlotArea& area, const std::vector<Tick>& x_ticks,
               const std::vector<Tick>& y_ticks) {
  for (const bool is_major : {false, true}) {
    const cv::Scalar& colour = is_major ? kGrid : kFaintGrid;
    for (const Tick& tick : x_ticks)
      if (tick.label.empty() != is_major)
        canvas.box({area.place_x(tick.value) - 0.5, area.box.y, 1.0, area.box.height}, colour);
    for (const Tick& tick : y_ticks)
      if (tick.label.empty() != is_major)
        canvas.box({area.box.x, area.place_y(tick.value) - 0.5, area.box.width, 1.0}, colour);
  }
}

void draw_tick_labels(Canvas& canvas, const PlotArea& area, const std::vector<Tick>& x_ticks,
                      const std::vector<Tick>& y_ticks) {
  for (const Tick& tick : x_ticks) {
    canvas.text(tick.label, {area.place_x(tick.value), area.box.br().y + 20.0}, kTickHeight, kPaleInk,
                Align::kCentre);
  }
  for (const Tick& tick : y_ticks) {
    canvas.text(tick.label, {area.box.x - 9.0, area.place_y(tick.value) + 0.5 * kTickHeight}, kTickHeight,
                kPaleInk, Align::kRight);
  }
}

void draw_axis_names(Canvas& canvas, const Chart& chart, const PlotArea& area) {
  const double room = 0.7 * area.box.width;
  canvas.text(Canvas::fitted(chart.y.label, kNameHeight, room), {area.box.x, area.box.y - 14.0}, kNameHeight,
              kPaleInk);
  canvas.text(Canvas::fitted(chart.x.label, kNameHeight, area.box.width),
              {area.box.x + 0.5 * area.box.width, area.box.br().y + 44.0}, kNameHeight, kPaleInk,
              Align::kCentre);
}

/// Labels of the vertical axis decide where the plot begins.
double left_edge(const std::vector<Tick>& y_ticks) {
  double widest = 0.0;
  for (const Tick& tick : y_ticks) widest = std::max(widest, Canvas::width_of(tick.label, kTickHeight));
  return std::max(kMargin, widest + 24.0);
}

bool has_shades(const Chart& chart) {
  return std::ranges::any_of(chart.series, [](const ChartSeries& s) { return !s.shade.empty(); });
}

}  // namespace

std::string chart_png(const Chart& chart) {
  check_chart(chart);
  const double width = chart.width, height = chart.plot_height;
  const ChartLegend legend(chart.series, width - 2.0 * kMargin - 40.0);
  const double top = kLegendLine + legend.height() + kAxisNameGap;
  const double right = width - kMargin - (has_shades(chart) ? kShadeBarSpace : 0.0);
  constexpr int kVerticalLabels = 8;
  PlotArea area = plot_area(chart, {kMargin, top, right - kMargin, height});
  const double left = left_edge(ticks_for(area.y, kVerticalLabels));
  area = plot_area(chart, {left, top, right - left, height});
  const auto x_ticks =
      horizontal_ticks(area, [](const std::string& label) { return Canvas::width_of(label, kTickHeight); });
  const auto y_ticks = ticks_for(area.y, kVerticalLabels);

  Canvas canvas(chart.width, static_cast<int>(top + height + kFootHeight));
  canvas.text(Canvas::fitted(chart.title, 16.0, width - kMargin - left), {left, kTitleLine}, 16.0, kInk);
  legend.draw(canvas, {left, kLegendLine});
  draw_grid(canvas, area, x_ticks, y_ticks);
  canvas.frame({area.box.x - 0.5, area.box.y - 0.5, area.box.width + 1.0, area.box.height + 1.0}, kGrid);
  for (const ChartSeries& series : chart.series) draw_band(canvas, series, area);
  for (const ChartSeries& series : chart.series) draw_series(canvas, series, area);
  draw_levels(canvas, chart.levels, area);
  draw_tick_labels(canvas, area, x_ticks, y_ticks);
  draw_axis_names(canvas, chart, area);
  if (has_shades(chart)) draw_shade_bar(canvas, chart.shade_label, area.box, width - kMargin);
  return canvas.png();
}

void write_chart(const std::filesystem::path& path, const Chart& chart) {
  write_file_atomically(path, chart_png(chart));
}

}  // namespace apriltrack
