#include "track_truth_page.h"

#include <fmt/format.h>

#include <limits>

#include "apriltrack/base/degrees.h"
#include "pages/error_chart.h"
#include "track_extent.h"

namespace apriltrack::app {
namespace {

std::string number_or_dash(const std::optional<double>& value, double factor, int decimals,
                           const std::string& unit) {
  return value ? fmt::format("{:.{}f} {}", factor * *value, decimals, unit) : "-";
}

HtmlTable truth_table(const TruthScore& score) {
  const ErrorSummary& all = score.evaluation.overall;
  const FrameLogEvaluation& log = score.log;
  HtmlTable table{
      {"figure", "value"},
      {{"frames whose truth shows a tag", fmt::format("{}", all.frames)},
       {"with a pose", fmt::format("{:.1f} %", 100.0 * all.coverage)},
       {"within 5 px", number_or_dash(all.success_5px, 100.0, 1, "%")},
       {"corner error, median", number_or_dash(all.median_px, 1.0, 3, "px")},
       {"corner error, 95 %", number_or_dash(all.p95_px, 1.0, 3, "px")},
       {"position error, median", number_or_dash(all.position_median_m, 1e3, 2, "mm")},
       {"position error, RMS", number_or_dash(all.position_rmse_m, 1e3, 2, "mm")},
       {"rotation error, median", number_or_dash(all.rotation_median_rad, kDegPerRad, 3, "degrees")},
       {"rotation error, RMS", number_or_dash(all.rotation_rmse_rad, kDegPerRad, 3, "degrees")}},
      "Shares are of all these frames; errors of those with a pose, predicted ones too. An honest "
      "covariance has normalised errors of 1."};
  if (log.claimed_good_but_over_10px)
    table.rows.push_back(
        {"silent failures: claimed on evidence, over 10 px off",
         fmt::format("{} of {} claimed", *log.claimed_good_but_over_10px, log.claimed_good)});
  if (log.nees_over_6_mean)
    table.rows.push_back(
        {"normalised error squared over 6",
         fmt::format("mean {:.2f}, median {:.2f}", *log.nees_over_6_mean, *log.nees_over_6_median)});
  return table;
}

SvgPicture error_chart_of_corners(const TruthScore& score, const TrackRecord& record) {
  Chart chart = corner_error_chart("Corner error over time");
  chart.x = time_axis(record);
  ChartSeries series{.name = "", .colour = kBlue, .mark = ChartMark::kLineAndPoints};
  add_corner_errors(series, score.evaluation.frames, record.rows().front().timestamp);
  chart.series.push_back(std::move(series));
  return chart_svg(chart);
}

/// Positions or rotations, `factor` from m or rad.
SvgPicture error_chart_of_poses(const TruthScore& score, const TrackRecord& record, double PoseError::*member,
                                double factor, const char* title, const char* label) {
  Chart chart;
  chart.title = title;
  chart.x = time_axis(record);
  chart.y = {.label = label, .is_logarithmic = true};
  ChartSeries series{.name = "", .colour = kBlue, .mark = ChartMark::kLineAndPoints};
  for (const FrameScore& frame : score.evaluation.frames) {
    series.x.push_back(seconds_between(record.rows().front().timestamp, frame.timestamp));
    series.y.push_back(frame.error ? factor * (*frame.error).*member
                                   : std::numeric_limits<double>::quiet_NaN());
  }
  chart.series.push_back(std::move(series));
  return chart_svg(chart);
}

}  // namespace

void add_truth_section(HtmlPage& page, const TruthScore& score, const TrackRecord& record) {
  page.heading("Against the truth");
  page.paragraph(score.is_map_the_recordings
                     ? "The recording brings its true poses (truth.tum); nothing is aligned."
                     : "The recording brings its true poses (truth.tum), in the frame of its own map. This "
                       "run used another map; nothing is aligned, so where the two maps' frames differ, that "
                       "is in the errors.");
  if (score.untried > 0) {
    page.paragraph(
        fmt::format("The run was interrupted: these are the figures of the {} true frames until then, "
                    "of {}; the {} after them were never tried, and count neither as lost nor as found.",
                    score.evaluation.truth_frames,
                    static_cast<std::size_t>(score.evaluation.truth_frames) + score.untried, score.untried));
  }
  page.table(truth_table(score));
  page.svg(error_chart_of_corners(score, record),
           "Mean distance of the visible tags' corners from where they truly are. A gap: no pose, or no tag "
           "in view.");
  page.svg(error_chart_of_poses(score, record, &PoseError::position_m, 1e3, "Position error over time",
                                "position error, mm"),
           "Distance from the true position; logarithmic.");
  page.svg(error_chart_of_poses(score, record, &PoseError::rotation_rad, kDegPerRad,
                                "Rotation error over time", "rotation error, degrees"),
           "Angle from the true orientation; logarithmic.");
}

}  // namespace apriltrack::app
