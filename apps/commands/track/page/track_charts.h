#pragma once

#include <string>
#include <vector>

#include "apriltrack/eval/run_statistics.h"
#include "apriltrack/motion/track_mode.h"
#include "apriltrack/report/svg_picture.h"
#include "commands/track/track_record.h"

namespace apriltrack::app {

/// A drawing, and what a page says below it.
struct ReportPicture {
  SvgPicture picture;
  std::string caption;
};

// Times are seconds since the first frame. Drawings stay small however many frames there are.

/// The status of every frame.
ReportPicture draw_statuses(const TrackRecord& record);
/// Positions with the band that their covariances claim. These two require a pose.
ReportPicture draw_position(const TrackRecord& record, TrackMode mode);
ReportPicture draw_rotation(const TrackRecord& record, TrackMode mode);
/// What the covariances claim, in mm and degrees.
ReportPicture draw_position_sigma(const TrackRecord& record);
ReportPicture draw_rotation_sigma(const TrackRecord& record);
ReportPicture draw_tags(const TrackRecord& record);
ReportPicture draw_latency(const TrackRecord& record, const RunStatistics& figures);

}  // namespace apriltrack::app
