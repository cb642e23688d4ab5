#include "chart_layout.h"

#include <cmath>

#include "apriltrack/base/check.h"

namespace apriltrack {
namespace {

void check_axis(const ChartAxis& axis) {
  for (const auto& end : {axis.low, axis.high}) {
    APRILTRACK_CHECK(!end || std::abs(*end) <= kLargestNumber, "an axis ends at finite numbers");
    APRILTRACK_CHECK(!end || !axis.is_logarithmic || *end > 0.0,
                     "a logarithmic axis ends at numbers above zero");
  }
  APRILTRACK_CHECK(!axis.low || !axis.high || *axis.low < *axis.high, "an axis ends above where it begins");
}

}  // namespace

void check_chart(const Chart& chart) {
  check_axis(chart.x);
  check_axis(chart.y);
  APRILTRACK_CHECK(chart.width >= 400 && chart.width <= 4000, "a chart is 400 to 4000 pixels wide");
  APRILTRACK_CHECK(chart.plot_height >= 100 && chart.plot_height <= 4000,
                   "a plot is 100 to 4000 pixels high");
  APRILTRACK_CHECK(!(chart.x.has_equal_scale || chart.y.has_equal_scale) ||
                       !(chart.x.is_logarithmic || chart.y.is_logarithmic),
                   "only linear axes can have equal scales");
  for (const ChartSeries& series : chart.series) {
    APRILTRACK_CHECK(series.x.size() == series.y.size(), "a series has as many x as y");
    APRILTRACK_CHECK(series.shade.empty() || series.shade.size() == series.x.size(),
                     "a series has no shades, or one for each point");
    APRILTRACK_CHECK(series.half_width.empty() || series.half_width.size() == series.x.size(),
                     "a series has no band, or a half width for each point");
    for (const double half_width : series.half_width)
      APRILTRACK_CHECK(!(half_width < 0.0), "a band's half widths are at least zero");
    APRILTRACK_CHECK(series.opacity > 0.0 && series.opacity <= 1.0, "an opacity lies in (0, 1]");
    for (const double shade : series.shade)
      APRILTRACK_CHECK(shade >= 0.0 && shade <= 1.0, "shades are numbers from 0 to 1");
  }
  for (const ChartLevel& level : chart.levels)
    APRILTRACK_CHECK(std::abs(level.y) <= kLargestNumber, "a level is a finite number");
}

PlotArea plot_area(const Chart& chart, cv::Rect2d box) {
  std::vector<double> x;
  std::vector<double> y;
  for (const ChartSeries& series : chart.series) {
    for (std::size_t i = 0; i < series.x.size(); ++i) {
      if (std::isnan(series.x[i]) || std::isnan(series.y[i])) continue;
      x.push_back(series.x[i]);
      y.push_back(series.y[i]);
    }
  }
  for (const ChartLevel& level : chart.levels) y.push_back(level.y);
  PlotArea area{range_for(chart.x, x), range_for(chart.y, y), box};
  if (chart.x.has_equal_scale || chart.y.has_equal_scale) equalise_scales(area, chart.x, chart.y);
  return area;
}

std::vector<Tick> horizontal_ticks(const PlotArea& area, double (*width_of)(const std::string&)) {
  constexpr double kLetterGap = 18.0;
  for (int max_labels = 11;; --max_labels) {
    const auto ticks = ticks_for(area.x, max_labels);
    double last_end = -1e9;
    bool fits = true;
    for (const Tick& tick : ticks) {
      if (tick.label.empty()) continue;
      const double half = 0.5 * width_of(tick.label);
      fits = fits && area.place_x(tick.value) - half > last_end + kLetterGap;
      last_end = area.place_x(tick.value) + half;
    }
    if (fits || max_labels <= 2) return ticks;
  }
}

}  // namespace apriltrack
