#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "apriltrack/report/chart.h"
#include "canvas.h"

namespace apriltrack {

/// The names of the series with samples of their marks, in as many rows as they need.
class ChartLegend {
 public:
  ChartLegend(const std::vector<ChartSeries>& series, double width);

  /// Of the rows after the first, in points.
  double height() const;
  /// at: left end of the first row's base line.
  void draw(Canvas& canvas, cv::Point2d at) const;

 private:
  struct Entry {
    const ChartSeries* series;
    std::string words;
    cv::Point2d offset;
  };
  std::vector<Entry> entries_;
};

/// The colours of shades 0 to 1, with numbers and name, right of the plot.
void draw_shade_bar(Canvas& canvas, const std::string& name, cv::Rect2d plot, double right);

}  // namespace apriltrack
