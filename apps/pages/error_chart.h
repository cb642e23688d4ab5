#pragma once

#include <string>
#include <vector>

#include "apriltrack/base/timestamp.h"
#include "apriltrack/eval/evaluate_trajectory.h"
#include "apriltrack/report/chart.h"

namespace apriltrack::app {

/// Corner errors in px, a logarithmic axis and the level of success; without series.
Chart corner_error_chart(const std::string& title);

/// A point for each frame, time in s since `start`; a gap where the frame has no error.
void add_corner_errors(ChartSeries& series, const std::vector<FrameScore>& frames, Timestamp start);

}  // namespace apriltrack::app
