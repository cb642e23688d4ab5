#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <limits>
#include <string>

#include "apriltrack/motion/track_mode.h"
#include "apriltrack/report/chart.h"
#include "commands/track/track_record.h"

namespace apriltrack::app {

inline constexpr std::array<const char*, 3> kAxisNames = {"x", "y", "z"};

/// The least and the largest of some numbers.
struct Ends {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;

  void add(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  double length() const { return high - low; }
};

/// Of a coordinate of the poses that rest on evidence, or of all where none does: predictions may fly far
/// off, and would leave nothing to be seen of the others. Requires a pose.
Ends ends_of(const TrackRecord& record, Eigen::Index axis);

/// With a little air; left to the chart where there is no length.
void set_ends(ChartAxis& axis, const Ends& ends);

/// Seconds since the first frame, to the last one: the same in all charts.
ChartAxis time_axis(const TrackRecord& record);

/// "of the camera in the map's frame": what positions are.
std::string describe_positions(TrackMode mode);

}  // namespace apriltrack::app
