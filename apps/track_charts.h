#pragma once

#include <string>
#include <vector>

#include "apriltrack/motion/track_mode.h"
#include "apriltrack/tags/tag_map.h"
#include "track_figures.h"

namespace apriltrack::app {

/// The bytes of a PNG file, and what a page says below it.
struct ReportPicture {
  std::string png;
  std::string caption;
};

// Times are seconds since the first frame. Pictures are of the same size however many frames there are.

/// The status of every frame.
ReportPicture draw_statuses(const TrackRecord& record);
/// Positions with the band that their covariances claim. These two require a pose.
ReportPicture draw_position(const TrackRecord& record, TrackMode mode);
ReportPicture draw_rotation(const TrackRecord& record, TrackMode mode);
/// What the covariances claim, in mm and degrees.
ReportPicture draw_position_sigma(const TrackRecord& record);
ReportPicture draw_rotation_sigma(const TrackRecord& record);
ReportPicture draw_tags(const TrackRecord& record);
ReportPicture draw_latency(const TrackRecord& record, const TrackFigures& figures);

/// The path with the map's tags, from the side on which most is seen; with a body's tags at its first pose.
/// Requires a pose.
ReportPicture draw_path(const TrackRecord& record, const TagMap& map, TrackMode mode);

}  // namespace apriltrack::app
