#include <algorithm>
#include <string>
#include <vector>

#include "apriltrack/base/check.h"
#include "apriltrack/report/chart.h"
#include "chart_layout.h"
#include "chart_svg_series.h"
#include "svg_inks.h"

namespace apriltrack {
namespace {

/// In units of the drawing.
struct SvgChartLayout {
  static constexpr double kWidth = 1010.0, kSide = 12.0, kTitle = 26.0, kLetters = 13.0, kSmall = 12.0;
  static constexpr double kLegendRow = 20.0, kToPlot = 34.0, kFoot = 52.0;
};
using L = SvgChartLayout;

double width_of_small(const std::string& label) {
  return svg_width_of(label, L::kSmall);
}

struct LegendEntry {
  const ChartSeries* series;
  std::string words;
  Eigen::Vector2d at;  ///< Of its mark's left end; from the first row's left end.
};

/// In as many rows as they need.
std::vector<LegendEntry> legend_of(const std::vector<ChartSeries>& all, double width) {
  constexpr double kMark = 26.0, kGap = 24.0;
  std::vector<LegendEntry> entries;
  Eigen::Vector2d at = Eigen::Vector2d::Zero();
  for (const ChartSeries& series : all) {
    if (series.name.empty()) continue;
    const std::string words = has_anything_to_draw(series) ? series.name : series.name + " (none)";
    const double room = kMark + svg_width_of(words, L::kLetters) + kGap;
    if (at.x() > 0.0 && at.x() + room > width) at = {0.0, at.y() + L::kLegendRow};
    entries.push_back({&series, words, at});
    at.x() += room;
  }
  return entries;
}

void draw_svg_legend(const std::vector<LegendEntry>& entries, const Eigen::Vector2d& origin,
                     SvgPicture& picture) {
  for (const LegendEntry& entry : entries) {
    const Eigen::Vector2d at = origin + entry.at;
    draw_svg_mark(*entry.series, at - Eigen::Vector2d(0.0, 4.0), at + Eigen::Vector2d(20.0, -4.0), picture);
    picture.text(at + Eigen::Vector2d(26.0, 0.0), entry.words, {.size = L::kLetters});
  }
}

void draw_svg_grid(const PlotArea& area, const std::vector<Tick>& x_ticks, const std::vector<Tick>& y_ticks,
                   SvgPicture& picture) {
  const auto style = [](const Tick& tick) {
    return SvgStyle{.stroke = SvgInk::kRule, .width = tick.label.empty() ? 0.4 : 0.9};
  };
  const double left = area.box.x, right = area.box.br().x, top = area.box.y, bottom = area.box.br().y;
  for (const Tick& tick : x_ticks) {
    const double x = area.place_x(tick.value);
    picture.line({x, top}, {x, bottom}, style(tick));
    if (!tick.label.empty())
      picture.text({x, bottom + 17.0}, tick.label,
                   {.size = L::kSmall, .ink = SvgInk::kPale, .anchor = SvgAnchor::kMiddle});
  }
  for (const Tick& tick : y_ticks) {
    const double y = area.place_y(tick.value);
    picture.line({left, y}, {right, y}, style(tick));
    if (!tick.label.empty())
      picture.text({left - 7.0, y + 4.0}, tick.label,
                   {.size = L::kSmall, .ink = SvgInk::kPale, .anchor = SvgAnchor::kEnd});
  }
  picture.rectangle({left, top}, {right - left, bottom - top}, {.stroke = SvgInk::kRule});
}

void draw_svg_levels(const std::vector<ChartLevel>& levels, const PlotArea& area, SvgPicture& picture) {
  for (const ChartLevel& level : levels) {
    const double part = area.y.fraction(level.y);
    if (part < 0.0 || part > 1.0 || (area.y.is_logarithmic && level.y <= 0.0)) continue;
    const double y = area.place_y(level.y);
    picture.line({area.box.x, y}, {area.box.br().x, y}, {.stroke = SvgInk::kText, .is_dashed = true});
    picture.text({area.box.br().x - 8.0, y - 5.0}, level.name,
                 {.size = L::kSmall, .anchor = SvgAnchor::kEnd, .has_halo = true});
  }
}

/// Labels of the vertical axis decide where the plot begins.
double left_of_plot(const std::vector<Tick>& y_ticks) {
  double widest = 20.0;
  for (const Tick& tick : y_ticks) widest = std::max(widest, width_of_small(tick.label));
  return L::kSide + widest + 12.0;
}

}  // namespace

SvgPicture chart_svg(const Chart& chart) {
  check_chart(chart);
  for (const ChartSeries& series : chart.series)
    APRILTRACK_CHECK(series.shade.empty(), "a drawing for a page has no shades");
  constexpr int kVerticalLabels = 8;
  const std::vector<LegendEntry> legend = legend_of(chart.series, L::kWidth - 2.0 * L::kSide);
  const double legend_top = L::kTitle + 24.0;
  const double top = (legend.empty() ? L::kTitle : legend_top + legend.back().at.y()) + L::kToPlot;
  const double height = chart.plot_height;
  PlotArea area = plot_area(chart, {L::kSide, top, L::kWidth - 2.0 * L::kSide, height});
  const double left = left_of_plot(ticks_for(area.y, kVerticalLabels));
  area = plot_area(chart, {left, top, L::kWidth - L::kSide - 10.0 - left, height});

  SvgPicture picture(L::kWidth, top + height + L::kFoot);
  picture.text({L::kSide, L::kTitle}, chart.title, {.size = 16.0, .is_bold = true});
  draw_svg_legend(legend, {L::kSide, legend_top}, picture);
  picture.text({area.box.x, top - 9.0}, chart.y.label, {.size = L::kLetters, .ink = SvgInk::kPale});
  picture.text({area.box.x + 0.5 * area.box.width, top + height + 40.0}, chart.x.label,
               {.size = L::kLetters, .ink = SvgInk::kPale, .anchor = SvgAnchor::kMiddle});
  draw_svg_grid(area, horizontal_ticks(area, width_of_small), ticks_for(area.y, kVerticalLabels), picture);
  for (const ChartSeries& series : chart.series) draw_svg_band(series, area, picture);
  for (const ChartSeries& series : chart.series) draw_svg_series(series, area, picture);
  draw_svg_levels(chart.levels, area, picture);
  return picture;
}

}  // namespace apriltrack
