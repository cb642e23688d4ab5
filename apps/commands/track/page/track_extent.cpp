#include "track_extent.h"

namespace apriltrack::app {

Ends ends_of(const TrackRecord& record, Eigen::Index axis) {
  Ends with_evidence, all;
  for (const FrameLogRow& row : record.rows()) {
    if (!row.pose) continue;
    const double value = row.pose->translation()[axis];
    all.add(value);
    if (claims_evidence(row)) with_evidence.add(value);
  }
  return with_evidence.length() >= 0.0 ? with_evidence : all;
}

void set_ends(ChartAxis& axis, const Ends& ends) {
  constexpr double kAir = 0.06;
  constexpr double kShortest_m = 1e-6;  // of a camera that stands still; else the chart chooses
  if (!(ends.length() > kShortest_m)) return;
  axis.low = ends.low - kAir * ends.length();
  axis.high = ends.high + kAir * ends.length();
}

ChartAxis time_axis(const TrackRecord& record) {
  ChartAxis axis{.label = "time, s"};
  const double duration_s = seconds_between(record.rows().front().timestamp, record.rows().back().timestamp);
  if (!(duration_s > 0.0)) return axis;
  axis.low = 0.0;
  axis.high = duration_s;
  return axis;
}

std::string describe_positions(TrackMode mode) {
  return mode == TrackMode::kEgo ? "of the camera in the map's frame"
                                 : "of the body in the camera's frame: x right, y down, z ahead";
}

}  // namespace apriltrack::app
