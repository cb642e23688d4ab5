#include "plot_area.h"

#include <algorithm>

namespace apriltrack {
namespace {

/// Grows to `length` at the ends that may move; false when neither may.
bool lengthen(AxisRange& range, const ChartAxis& axis, double length) {
  const double more = length - (range.high - range.low);
  if (axis.low && axis.high) return false;
  const double below = axis.low ? 0.0 : axis.high ? more : 0.5 * more;
  range.low -= below;
  range.high += more - below;
  return true;
}

}  // namespace

cv::Point2d PlotArea::held(cv::Point2d point) const {
  return {std::clamp(point.x, box.x, box.br().x), std::clamp(point.y, box.y, box.br().y)};
}

std::optional<std::pair<cv::Point2d, cv::Point2d>> PlotArea::clipped(cv::Point2d from, cv::Point2d to) const {
  const cv::Point2d step = to - from;
  double enter = 0.0;
  double leave = 1.0;
  // Each border: how fast the line runs out through it, and how much room there is before it does.
  const std::pair<double, double> borders[] = {{-step.x, from.x - box.x},
                                               {step.x, box.br().x - from.x},
                                               {-step.y, from.y - box.y},
                                               {step.y, box.br().y - from.y}};
  for (const auto& [speed, room] : borders) {
    if (speed == 0.0 && room < 0.0) return std::nullopt;
    if (speed > 0.0) leave = std::min(leave, room / speed);
    if (speed < 0.0) enter = std::max(enter, room / speed);
  }
  if (enter > leave) return std::nullopt;
  return std::pair(from + enter * step, from + leave * step);
}

void equalise_scales(PlotArea& area, const ChartAxis& x, const ChartAxis& y) {
  const double x_length = area.x.high - area.x.low;
  const double y_length = area.y.high - area.y.low;
  const double units_per_point = std::max(x_length / area.box.width, y_length / area.box.height);
  if (!lengthen(area.x, x, units_per_point * area.box.width)) {
    const double width = x_length / units_per_point;
    area.box.x += 0.5 * (area.box.width - width);
    area.box.width = width;
  }
  if (!lengthen(area.y, y, units_per_point * area.box.height)) {
    const double height = y_length / units_per_point;
    area.box.y += 0.5 * (area.box.height - height);
    area.box.height = height;
  }
}

}  // namespace apriltrack
