#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <utility>

#include "chart_axis.h"

namespace apriltrack {

/// Where a chart's numbers lie on the canvas.
struct PlotArea {
  AxisRange x, y;
  cv::Rect2d box;

  double place_x(double value) const { return box.x + box.width * x.fraction(value); }
  double place_y(double value) const { return box.y + box.height * (1.0 - y.fraction(value)); }
  /// Inside the box or beyond.
  cv::Point2d place(double at_x, double at_y) const { return {place_x(at_x), place_y(at_y)}; }
  /// Moved to the edge of the box if it lies beyond.
  cv::Point2d held(cv::Point2d point) const;
  /// The part of a line that lies in the box (Liang and Barsky 1984).
  std::optional<std::pair<cv::Point2d, cv::Point2d>> clipped(cv::Point2d from, cv::Point2d to) const;
};

/// Makes one unit as long on the horizontal axis as on the vertical one: lengthens an axis at its open ends,
/// or else narrows the box about its middle.
void equalise_scales(PlotArea& area, const ChartAxis& x, const ChartAxis& y);

}  // namespace apriltrack
