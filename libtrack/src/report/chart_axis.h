#pragma once

#include <string>
#include <vector>

#include "apriltrack/report/chart.h"

namespace apriltrack {

/// Farther numbers count as infinite, so that no length of an axis does.
constexpr double kLargestNumber = 1e300;

/// The numbers that an axis shows.
struct AxisRange {
  double low = 0.0;
  double high = 1.0;
  bool is_logarithmic = false;

  /// 0 at the axis' lower end, 1 at its upper end; not NaN for a value that is not.
  double fraction(double value) const;
};

/// An end that the axis leaves open is chosen to hold all values that can be shown: with a little air and
/// from 0 where that is near, or, on a logarithmic axis, at 1, 2 or 5 times a power of ten.
AxisRange range_for(const ChartAxis& axis, const std::vector<double>& values);

struct Tick {
  double value = 0.0;
  std::string label;  ///< Empty for a line of the minor grid.
};

/// Round numbers within the range: 1, 2 or 5 times a power of ten apart; decades on a logarithmic axis, with
/// what lies between as minor ticks. At most max_labels of them have labels, where that is 2 or more.
std::vector<Tick> ticks_for(const AxisRange& range, int max_labels);

}  // namespace apriltrack
