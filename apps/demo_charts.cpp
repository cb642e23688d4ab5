#include "demo_charts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "apriltrack/report/chart.h"

namespace apriltrack::app {
namespace {

constexpr double kLimit_px = 5.0;

Colour colour_of(const std::string& method) {
  if (method == "pnp") return kVermilion;
  if (method == "paper") return kOrange;
  return kBlue;
}

const char* legend(const std::string& method) {
  if (method == "pnp") return "pnp: detection alone";
  if (method == "paper") return "paper: its particle filter";
  return "blur: AprilTrack";
}

ChartAxis error_axis() {
  return {.label = "corner error, px", .is_logarithmic = true, .low = 0.01, .high = 1000.0};
}

Chart chart_of(const DemoScene& scene, const char* what) {
  Chart chart;
  chart.title = fmt::format("{}: {}", scene.name, what);
  chart.y = error_axis();
  chart.levels = {{kLimit_px, "5 px"}};
  return chart;
}

ChartSeries series_of(const DemoScore& score, ChartMark mark) {
  ChartSeries series;
  series.name = legend(score.method);
  series.colour = colour_of(score.method);
  series.mark = mark;
  return series;
}

void add_points(ChartSeries& series, const std::vector<FrameScore>& frames, Timestamp start) {
  for (const FrameScore& frame : frames) {
    series.x.push_back(seconds_between(start, frame.timestamp));
    series.y.push_back(frame.corner_error_px.value_or(std::numeric_limits<double>::quiet_NaN()));
  }
}

}  // namespace

void draw_error_over_time(const std::filesystem::path& picture, const DemoScene& scene,
                          const std::vector<DemoScore>& scores) {
  Chart chart = chart_of(scene, "error over time, a gap where there is no pose");
  chart.x = {.label = "time, s"};
  ChartSeries predicted{
      .name = "blur: predicted, and says so", .colour = kSkyBlue, .mark = ChartMark::kPoints};
  for (const DemoScore& score : scores) {
    if (score.scene != &scene) continue;
    const Timestamp start = score.evaluation.frames.front().timestamp;
    chart.series.push_back(series_of(score, ChartMark::kLine));
    add_points(chart.series.back(), score.evaluation.frames, start);
    if (score.method == "blur") add_points(predicted, score.predicted, start);
  }
  chart.series.push_back(predicted);
  write_chart(picture, chart);
}

void draw_error_against_blur(const std::filesystem::path& picture, const DemoScene& scene,
                             const std::vector<DemoScore>& scores) {
  Chart chart = chart_of(scene, "error against motion blur, a point for every pose");
  chart.x = {.label = "motion blur of the worst corner, px"};
  for (const DemoScore& score : scores) {
    if (score.scene != &scene) continue;
    ChartSeries series = series_of(score, ChartMark::kPoints);
    for (const FrameScore& frame : score.evaluation.frames) {
      if (!frame.corner_error_px) continue;
      series.x.push_back(frame.blur_px);
      series.y.push_back(*frame.corner_error_px);
    }
    chart.series.push_back(series);
  }
  write_chart(picture, chart);
}

}  // namespace apriltrack::app
