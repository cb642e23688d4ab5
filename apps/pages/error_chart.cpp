#include "error_chart.h"

#include <limits>

namespace apriltrack::app {

Chart corner_error_chart(const std::string& title) {
  constexpr double kLimit_px = 5.0;
  Chart chart;
  chart.title = title;
  chart.y = {.label = "corner error, px", .is_logarithmic = true, .low = 0.01, .high = 1000.0};
  chart.levels = {{kLimit_px, "5 px"}};
  return chart;
}

void add_corner_errors(ChartSeries& series, const std::vector<FrameScore>& frames, Timestamp start) {
  for (const FrameScore& frame : frames) {
    series.x.push_back(seconds_between(start, frame.timestamp));
    series.y.push_back(frame.corner_error_px.value_or(std::numeric_limits<double>::quiet_NaN()));
  }
}

}  // namespace apriltrack::app
