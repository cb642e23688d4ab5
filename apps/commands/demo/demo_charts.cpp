#include "demo_charts.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "pages/error_chart.h"

namespace apriltrack::app {
namespace {

/// Apart in hue and in lightness.
Colour colour_of(const std::string& method) {
  if (method == "pnp") return kBlack;
  if (method == "paper") return kOrange;
  return kBlue;
}

/// Where methods agree their marks lie on each other: those of pnp come last, and are hollow.
const std::vector<std::string> kDrawingOrder = {"paper", "blur", "pnp"};

ChartMark point_mark(const std::string& method) {
  if (method == "pnp") return ChartMark::kRings;
  return method == "paper" ? ChartMark::kCrosses : ChartMark::kPoints;
}

const char* legend(const std::string& method) {
  if (method == "pnp") return "pnp: detection alone";
  if (method == "paper") return "paper: its particle filter";
  return "blur: AprilTrack";
}

Chart chart_of(const DemoScene& scene, const char* what) {
  return corner_error_chart(fmt::format("{}: {}", scene.name, what));
}

/// The scores of the scene, as they are to be drawn.
std::vector<const DemoScore*> drawn_of(const DemoScene& scene, const std::vector<DemoScore>& scores) {
  std::vector<const DemoScore*> drawn;
  for (const std::string& method : kDrawingOrder) {
    for (const DemoScore& score : scores) {
      if (score.scene == &scene && score.method == method) drawn.push_back(&score);
    }
  }
  return drawn;
}

ChartSeries series_of(const DemoScore& score, ChartMark mark) {
  ChartSeries series;
  series.name = legend(score.method);
  series.colour = colour_of(score.method);
  series.mark = mark;
  return series;
}

/// The blur tracker's poses that are not claimed; drawn last, on everything.
ChartSeries predicted_series() {
  return {.name = "blur: predicted, and says so", .colour = kSkyBlue, .mark = ChartMark::kPoints};
}

std::vector<FrameScore> without_predicted(const DemoScore& score) {
  const auto time_ns = [](const FrameScore& frame) { return frame.timestamp.ns; };
  std::vector<FrameScore> rest;
  std::ranges::set_difference(score.evaluation.frames, score.predicted, std::back_inserter(rest), {}, time_ns,
                              time_ns);
  return rest;
}

void add_errors_by_blur(ChartSeries& series, const std::vector<FrameScore>& frames) {
  for (const FrameScore& frame : frames) {
    if (!frame.corner_error_px) continue;
    series.x.push_back(frame.blur_px);
    series.y.push_back(*frame.corner_error_px);
  }
}

}  // namespace

void draw_error_over_time(const std::filesystem::path& picture, const DemoScene& scene,
                          const std::vector<DemoScore>& scores) {
  Chart chart = chart_of(scene, "error over time; no ring, or a gap: no pose");
  chart.x = {.label = "time, s"};
  ChartSeries predicted = predicted_series();
  for (const DemoScore* score : drawn_of(scene, scores)) {
    const Timestamp start = score->evaluation.frames.front().timestamp;
    chart.series.push_back(series_of(*score, score->method == "pnp" ? ChartMark::kRings : ChartMark::kLine));
    add_corner_errors(chart.series.back(), score->evaluation.frames, start);
    if (score->method == "blur") add_corner_errors(predicted, score->predicted, start);
  }
  chart.series.push_back(predicted);
  write_chart(picture, chart);
}

void draw_error_against_blur(const std::filesystem::path& picture, const DemoScene& scene,
                             const std::vector<DemoScore>& scores) {
  Chart chart = chart_of(scene, "error against motion blur, a mark for every pose");
  chart.x = {.label = "motion blur of the worst corner, px"};
  ChartSeries predicted = predicted_series();
  for (const DemoScore* score : drawn_of(scene, scores)) {
    const bool is_blur = score->method == "blur";
    chart.series.push_back(series_of(*score, point_mark(score->method)));
    add_errors_by_blur(chart.series.back(), is_blur ? without_predicted(*score) : score->evaluation.frames);
    if (is_blur) add_errors_by_blur(predicted, score->predicted);
  }
  chart.series.push_back(predicted);
  write_chart(picture, chart);
}

}  // namespace apriltrack::app
