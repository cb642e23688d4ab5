#include "chart_legend.h"

#include <cmath>

#include "chart_series.h"

namespace apriltrack {
namespace {

constexpr double kLetterHeight = 10.0;
constexpr double kSampleWidth = 24.0;
constexpr double kSampleGap = 9.0;
constexpr double kEntryGap = 30.0;
constexpr double kRowHeight = 22.0;

bool is_empty(const ChartSeries& series) {
  for (std::size_t i = 0; i < series.x.size(); ++i)
    if (!std::isnan(series.x[i]) && !std::isnan(series.y[i])) return false;
  return true;
}

void draw_sample(Canvas& canvas, const ChartSeries& series, cv::Point2d at) {
  const double y = at.y - 0.5 * kLetterHeight;
  if (draws_line(series))
    canvas.line({at.x + 1.0, y}, {at.x + kSampleWidth - 1.0, y}, bgr_of(series.colour), 2.0);
  if (!draws_points(series)) return;
  if (series.shade.empty())
    return draw_mark(canvas, series, {at.x + 0.5 * kSampleWidth, y}, 3.5, bgr_of(series.colour));
  for (const double shade : {0.15, 0.5, 0.85})
    canvas.disc({at.x + kSampleWidth * shade, y}, 3.5, shade_colour(shade));
}

}  // namespace

ChartLegend::ChartLegend(const std::vector<ChartSeries>& series, double width) {
  cv::Point2d next(0.0, 0.0);
  for (const ChartSeries& one : series) {
    if (one.name.empty()) continue;
    const std::string remark = is_empty(one) ? " (none)" : "";
    const double room = width - kSampleWidth - kSampleGap - Canvas::width_of(remark, kLetterHeight);
    const std::string words = Canvas::fitted(one.name, kLetterHeight, room) + remark;
    const double length = kSampleWidth + kSampleGap + Canvas::width_of(words, kLetterHeight);
    if (next.x > 0.0 && next.x + length > width) next = {0.0, next.y + kRowHeight};
    entries_.push_back({&one, words, next});
    next.x += length + kEntryGap;
  }
}

double ChartLegend::height() const {
  return entries_.empty() ? 0.0 : entries_.back().offset.y;
}

void ChartLegend::draw(Canvas& canvas, cv::Point2d at) const {
  for (const Entry& entry : entries_) {
    const cv::Point2d start = at + entry.offset;
    draw_sample(canvas, *entry.series, start);
    canvas.text(entry.words, {start.x + kSampleWidth + kSampleGap, start.y}, kLetterHeight, kInk);
  }
}

void draw_shade_bar(Canvas& canvas, const std::string& name, cv::Rect2d plot, double right) {
  constexpr double kBarWidth = 14.0;
  const double x = right - 44.0;
  for (double y = 0.0; y < plot.height; y += 1.0)
    canvas.box({x, plot.y + y, kBarWidth, 1.0}, shade_colour(1.0 - y / plot.height));
  for (const auto& [shade, label] : {std::pair(0.0, "0"), std::pair(0.5, "0.5"), std::pair(1.0, "1")})
    canvas.text(label, {x + kBarWidth + 8.0, plot.y + plot.height * (1.0 - shade) + 4.5}, 9.0, kPaleInk);
  canvas.text(Canvas::fitted(name, kLetterHeight, 0.3 * plot.width), {right, plot.y - 14.0}, kLetterHeight,
              kPaleInk, Align::kRight);
}

}  // namespace apriltrack
