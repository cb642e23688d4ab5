#include "track_charts.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "apriltrack/base/degrees.h"
#include "apriltrack/report/chart.h"
#include "apriltrack/report/event_lanes.h"
#include "apriltrack/report/lengths.h"
#include "pages/status_colours.h"
#include "track_extent.h"

namespace apriltrack::app {
namespace {

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();
constexpr std::array<Colour, 3> kAxisColours = {kVermilion, kBluishGreen, kBlue};

/// What a chart shows of a row; NaN: nothing.
using RowValue = std::function<double(const FrameLogRow&)>;

double time_of(const TrackRecord& record, const FrameLogRow& row) {
  return seconds_between(record.rows().front().timestamp, row.timestamp);
}

ChartSeries series_over_time(const TrackRecord& record, ChartSeries series, const RowValue& value) {
  for (const FrameLogRow& row : record.rows()) {
    series.x.push_back(time_of(record, row));
    series.y.push_back(value(row));
  }
  return series;
}

/// Each number until the next frame; a gap where a frame could not be read.
ChartSeries counts_over_time(const TrackRecord& record, ChartSeries series,
                             const std::function<int(const FrameLogRow&)>& count) {
  const std::string unreadable = to_string(TrackStatus::kUnreadable);
  const std::vector<FrameLogRow>& rows = record.rows();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double number = rows[i].status == unreadable ? kNothing : count(rows[i]);
    for (const std::size_t end : {i, std::min(i + 1, rows.size() - 1)}) {
      series.x.push_back(time_of(record, rows[end]));
      series.y.push_back(number);
    }
  }
  return series;
}

/// A series for each status that brings a pose, in its colour.
std::vector<ChartSeries> by_status(const TrackRecord& record, const RowValue& value) {
  std::vector<ChartSeries> all;
  for (const TrackStatus status : {TrackStatus::kDetected, TrackStatus::kTracked, TrackStatus::kPredicted}) {
    const std::string word = to_string(status);
    all.push_back(
        series_over_time(record, {.name = word, .colour = colour_of(status), .mark = ChartMark::kPoints},
                         [&](const FrameLogRow& row) { return row.status == word ? value(row) : kNothing; }));
  }
  return all;
}

/// Standard deviation of the position along an axis of the map (ego) or of the camera (joint): the covariance
/// speaks of the frame on the right.
double sigma_along(const FrameLogRow& row, Eigen::Index axis) {
  if (!row.pose || !row.covariance) return kNothing;
  const Eigen::RowVector3d direction = row.pose->rotation_matrix().row(axis);
  return std::sqrt(
      std::max(0.0, (direction * row.covariance->topLeftCorner<3, 3>() * direction.transpose()).value()));
}

/// The rotation vectors of one orientation differ by whole turns: the one nearest to `previous`.
Eigen::Vector3d unwrapped(const Eigen::Vector3d& vector, const Eigen::Vector3d& previous) {
  const double angle = vector.norm();
  if (angle < 1e-9) return vector;
  const Eigen::Vector3d axis = vector / angle;
  constexpr double kTurn = 2.0 * std::numbers::pi;
  return axis * (angle + kTurn * std::round((axis.dot(previous) - angle) / kTurn));
}

/// For every row the rotation vector of the turn since the first pose, along the axes of positions.
std::vector<Eigen::Vector3d> turns_since_first(const TrackRecord& record) {
  std::vector<Eigen::Vector3d> turns;
  Eigen::Vector3d previous = Eigen::Vector3d::Zero();
  for (const FrameLogRow& row : record.rows()) {
    if (row.pose) {
      const Pose turn(row.pose->rotation() * record.trajectory().front().pose.rotation().conjugate(),
                      Eigen::Vector3d::Zero());
      previous = unwrapped(turn.log().tail<3>(), previous);
    }
    turns.push_back(row.pose ? previous : Eigen::Vector3d::Constant(kNothing));
  }
  return turns;
}

ReportPicture draw_sigma(const TrackRecord& record, const std::string& what, const std::string& unit,
                         const RowValue& sigma) {
  Chart chart;
  chart.title = fmt::format("Claimed error of the {}", what);
  chart.x = time_axis(record);
  chart.y = {.label = fmt::format("sigma of the {}, {}", what, unit), .is_logarithmic = true};
  chart.series = by_status(record, sigma);
  return {chart_svg(chart),
          fmt::format("The length of the {} error that the covariance expects, root mean square, {}; "
                      "logarithmic. Where it is high, the pose is weakly held.",
                      what, unit)};
}

}  // namespace

ReportPicture draw_statuses(const TrackRecord& record) {
  std::vector<EventLane> lanes;
  for (const TrackStatus status : kTrackStatuses) lanes.push_back({to_string(status), ink_of_status(status)});
  std::vector<LaneEvent> events;
  for (const FrameLogRow& row : record.rows())
    events.push_back({time_of(record, row), index_of_status(row.status)});
  return {event_lanes_svg("Status of every frame", lanes, events),
          "A bar for each frame. Poses rest on evidence in the two upper rows only."};
}

ReportPicture draw_position(const TrackRecord& record, TrackMode mode) {
  double longest_m = 0.0;
  for (const Eigen::Index axis : {0, 1, 2}) {
    const Ends ends = ends_of(record, axis);
    longest_m = std::max({longest_m, std::abs(ends.low), std::abs(ends.high)});
  }
  const LengthUnit unit = unit_for(longest_m);
  Chart chart;
  chart.title = "Position";
  chart.x = time_axis(record);
  Ends shown;
  for (const Eigen::Index axis : {0, 1, 2}) {
    const auto i = static_cast<std::size_t>(axis);
    ChartSeries series = series_over_time(
        record, {.name = kAxisNames[i], .colour = kAxisColours[i]}, [&](const FrameLogRow& row) {
          return row.pose ? unit.per_m * row.pose->translation()[axis] : kNothing;
        });
    for (const FrameLogRow& row : record.rows())
      series.half_width.push_back(2.0 * unit.per_m * sigma_along(row, axis));
    const Ends ends = ends_of(record, axis);
    shown.add(unit.per_m * ends.low);
    shown.add(unit.per_m * ends.high);
    chart.series.push_back(std::move(series));
  }
  chart.y = {.label = fmt::format("position, {}", unit.name)};
  set_ends(chart.y, shown);
  return {
      chart_svg(chart),
      fmt::format(
          "Position {}. The translucent band is what the covariance allows, 2 sigma to either side: an "
          "honest one holds the truth in 95 % of the frames. Unseen, it is thinner than the line. A gap: no "
          "pose. Predictions do not stretch the axis.",
          describe_positions(mode))};
}

ReportPicture draw_rotation(const TrackRecord& record, TrackMode mode) {
  Chart chart;
  chart.title = "Rotation since the first pose";
  chart.x = time_axis(record);
  chart.y = {.label = "rotation vector, degrees"};
  const std::vector<Eigen::Vector3d> turns = turns_since_first(record);
  for (std::size_t i = 0; i < 3; ++i) {
    ChartSeries series{.name = fmt::format("about {}", kAxisNames[i]), .colour = kAxisColours[i]};
    for (std::size_t k = 0; k < turns.size(); ++k) {
      series.x.push_back(time_of(record, record.rows()[k]));
      series.y.push_back(kDegPerRad * turns[k][static_cast<Eigen::Index>(i)]);
    }
    chart.series.push_back(std::move(series));
  }
  return {chart_svg(chart),
          fmt::format("The turn from the first pose as a rotation vector (its length is the "
                      "angle), along the axes of the {}; past half a turn it counts on.",
                      mode == TrackMode::kEgo ? "map" : "camera")};
}

ReportPicture draw_position_sigma(const TrackRecord& record) {
  return draw_sigma(record, "position", "mm", [](const FrameLogRow& row) {
    return row.covariance ? 1e3 * std::sqrt(row.covariance->topLeftCorner<3, 3>().trace()) : kNothing;
  });
}

ReportPicture draw_rotation_sigma(const TrackRecord& record) {
  return draw_sigma(record, "rotation", "degrees", [](const FrameLogRow& row) {
    return row.covariance ? kDegPerRad * std::sqrt(row.covariance->bottomRightCorner<3, 3>().trace())
                          : kNothing;
  });
}

ReportPicture draw_tags(const TrackRecord& record) {
  constexpr double kLeastHigh = 8.0;  // so that no grid line lies between whole numbers
  Chart chart;
  chart.title = "Tags of the map in each frame";
  chart.x = time_axis(record);
  chart.y = {.label = "tags", .low = 0.0, .high = kLeastHigh};
  chart.series.push_back(counts_over_time(record, {.name = "detected", .colour = kBluishGreen},
                                          [](const FrameLogRow& row) { return row.tags_detected; }));
  chart.series.push_back(counts_over_time(record, {.name = "used for the pose", .colour = kBlue},
                                          [](const FrameLogRow& row) { return row.tags_tracked; }));
  for (const FrameLogRow& row : record.rows())
    chart.y.high = std::max({*chart.y.high, row.tags_detected + 1.0, row.tags_tracked + 1.0});
  return {
      chart_svg(chart),
      "Detected: tags of the map that were read in the frame. Used: those whose evidence the pose rests "
      "on, read or not. While the blur tracker knows where it is, it looks for tags in the whole image only "
      "once a second, and at some of those that it expects in between: detected then has a spike every "
      "second, and few detected tags are no lack of evidence. A pose from one tag is weakly held in depth "
      "and tilt."};
}

ReportPicture draw_latency(const TrackRecord& record, const RunStatistics& figures) {
  Chart chart;
  chart.title = "Latency";
  chart.x = time_axis(record);
  chart.y = {.label = "latency, ms", .is_logarithmic = true};
  chart.series.push_back(
      series_over_time(record, {.name = "", .colour = kBlue, .mark = ChartMark::kPoints},
                       [](const FrameLogRow& row) { return row.latency_ms.value_or(kNothing); }));
  if (figures.latency_p50_ms)
    chart.levels.push_back(
        {*figures.latency_p50_ms, fmt::format("median {:.1f} ms", *figures.latency_p50_ms)});
  std::string interval;
  if (figures.frames > 1 && figures.duration_s > 0.0) {
    const double ms = 1e3 * figures.duration_s / static_cast<double>(figures.frames - 1);
    chart.levels.push_back({ms, fmt::format("a frame every {:.1f} ms", ms)});
    interval = " Above the time between frames the run is slower than the camera.";
  }
  return {chart_svg(chart),
          "From the decoded image (or the given corners) to the pose, other frames at work beside it unless "
          "--threads is 1; logarithmic." +
              interval};
}

}  // namespace apriltrack::app
