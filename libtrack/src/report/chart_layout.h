#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "apriltrack/report/chart.h"
#include "chart_axis.h"
#include "plot_area.h"

namespace apriltrack {

/// What write_chart() requires.
void check_chart(const Chart& chart);

/// The axes' ranges for all that is shown, over a box.
PlotArea plot_area(const Chart& chart, cv::Rect2d box);

/// As many ticks as their labels, of that width each, leave room for.
std::vector<Tick> horizontal_ticks(const PlotArea& area, double (*width_of)(const std::string&));

}  // namespace apriltrack
