#pragma once

#include "apriltrack/report/chart.h"
#include "plot_area.h"

namespace apriltrack {

/// Whether any of its numbers is no gap.
bool has_anything_to_draw(const ChartSeries& series);

/// The translucent band behind a series' line, if it has one.
void draw_svg_band(const ChartSeries& series, const PlotArea& area, SvgPicture& picture);
void draw_svg_series(const ChartSeries& series, const PlotArea& area, SvgPicture& picture);
/// For the legend, in a line from left to right.
void draw_svg_mark(const ChartSeries& series, const Eigen::Vector2d& left, const Eigen::Vector2d& right,
                   SvgPicture& picture);

}  // namespace apriltrack
