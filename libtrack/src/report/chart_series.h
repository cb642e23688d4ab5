#pragma once

#include <vector>

#include "apriltrack/report/chart.h"
#include "canvas.h"
#include "plot_area.h"

namespace apriltrack {

constexpr double kLineWidth = 1.0;

/// Of a shade in [0, 1].
cv::Scalar shade_colour(double shade);

/// One point of the series.
void draw_mark(Canvas& canvas, const ChartSeries& series, cv::Point2d at, double radius,
               const cv::Scalar& colour);

bool draws_points(const ChartSeries& series);
bool draws_line(const ChartSeries& series);

/// Below all lines.
void draw_band(Canvas& canvas, const ChartSeries& series, const PlotArea& area);
void draw_series(Canvas& canvas, const ChartSeries& series, const PlotArea& area);

/// Over the series, lest they hide what they are measured by.
void draw_levels(Canvas& canvas, const std::vector<ChartLevel>& levels, const PlotArea& area);

}  // namespace apriltrack
