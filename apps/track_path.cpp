#include <fmt/format.h>

#include <array>
#include <functional>
#include <limits>
#include <vector>

#include "status_colours.h"
#include "track_charts.h"
#include "track_extent.h"

namespace apriltrack::app {
namespace {

constexpr double kGapInPath = std::numeric_limits<double>::quiet_NaN();

/// The two axes along which most happens, the first one first in their order.
std::array<Eigen::Index, 2> widest_plane(const std::array<Ends, 3>& ends) {
  Eigen::Index least = 2;  // in a tie, from above
  for (const Eigen::Index axis : {1, 0})
    if (ends[static_cast<std::size_t>(axis)].length() < ends[static_cast<std::size_t>(least)].length())
      least = axis;
  if (least == 0) return {1, 2};
  return {0, least == 1 ? 2 : 1};
}

/// Corners of the map's tags in the frame of the path.
std::vector<std::array<Eigen::Vector3d, 4>> tags_of_path(const TrackRecord& record, const TagMap& map,
                                                         TrackMode mode) {
  const Pose T_path_map = mode == TrackMode::kEgo ? Pose::identity() : record.trajectory().front().pose;
  std::vector<std::array<Eigen::Vector3d, 4>> tags;
  for (const MapTag& tag : map.tags) {
    tags.push_back(corners_in_map(tag));
    for (Eigen::Vector3d& corner : tags.back()) corner = T_path_map * corner;
  }
  return tags;
}

/// All outlines as one line with gaps.
ChartSeries outlines_of(const std::vector<std::array<Eigen::Vector3d, 4>>& tags, std::string name,
                        std::array<Eigen::Index, 2> plane) {
  ChartSeries series{.name = std::move(name), .colour = kBlack};
  for (const auto& corners : tags) {
    for (const std::size_t i : {0, 1, 2, 3, 0}) {
      series.x.push_back(corners[i][plane[0]]);
      series.y.push_back(corners[i][plane[1]]);
    }
    series.x.push_back(kGapInPath);
    series.y.push_back(kGapInPath);
  }
  return series;
}

ChartSeries path_of(const TrackRecord& record, ChartSeries series, std::array<Eigen::Index, 2> plane,
                    const std::function<bool(const FrameLogRow&)>& is_shown) {
  for (const FrameLogRow& row : record.rows()) {
    const bool is_there = row.pose && is_shown(row);
    series.x.push_back(is_there ? row.pose->translation()[plane[0]] : kGapInPath);
    series.y.push_back(is_there ? row.pose->translation()[plane[1]] : kGapInPath);
  }
  return series;
}

}  // namespace

ReportPicture draw_path(const TrackRecord& record, const TagMap& map, TrackMode mode) {
  const auto tags = tags_of_path(record, map, mode);
  std::array<Ends, 3> ends;
  for (const Eigen::Index axis : {0, 1, 2}) {
    Ends& along = ends[static_cast<std::size_t>(axis)];
    along = ends_of(record, axis);
    for (const auto& corners : tags)
      for (const Eigen::Vector3d& corner : corners) along.add(corner[axis]);
  }
  const auto plane = widest_plane(ends);
  const auto name = [&](std::size_t i) { return kAxisNames[static_cast<std::size_t>(plane[i])]; };
  const auto any = [](const FrameLogRow&) { return true; };
  const bool is_ego = mode == TrackMode::kEgo;
  Chart chart;
  chart.title = is_ego ? "The camera's path" : "The body's path";
  chart.x = {.label = fmt::format("{}, m", name(0)), .has_equal_scale = true};
  chart.y = {.label = fmt::format("{}, m", name(1)), .has_equal_scale = true};
  set_ends(chart.x, ends[static_cast<std::size_t>(plane[0])]);
  set_ends(chart.y, ends[static_cast<std::size_t>(plane[1])]);
  chart.series.push_back(
      outlines_of(tags, is_ego ? "tags of the map" : "tags of the body, at its first pose", plane));
  chart.series.push_back(path_of(record, {.name = "", .colour = kPaleGrey}, plane, any));
  for (const TrackStatus status : {TrackStatus::kDetected, TrackStatus::kTracked, TrackStatus::kPredicted}) {
    const std::string word = to_string(status);
    chart.series.push_back(path_of(record,
                                   {.name = word, .colour = colour_of(status), .mark = ChartMark::kPoints},
                                   plane, [&](const FrameLogRow& row) { return row.status == word; }));
  }
  const std::size_t unseen = static_cast<std::size_t>(3 - plane[0] - plane[1]);
  return {chart_png(chart),
          fmt::format("Positions {}, seen along {}, the axis along which path and tags spread least.",
                      describe_positions(mode), kAxisNames[unseen])};
}

}  // namespace apriltrack::app
