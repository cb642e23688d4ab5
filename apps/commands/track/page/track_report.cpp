#include "track_report.h"

#include <fmt/format.h>

#include "apriltrack/base/error.h"
#include "apriltrack/eval/run_statistics.h"
#include "apriltrack/report/html_page.h"
#include "commands/track/track_truth.h"
#include "track_charts.h"
#include "track_drawings.h"
#include "track_report_tables.h"
#include "track_truth_page.h"

namespace apriltrack::app {
namespace {

void add_picture(HtmlPage& page, const ReportPicture& picture) {
  page.svg(picture.picture, picture.caption);
}

/// What must not be overlooked stands above all figures.
void add_warnings(HtmlPage& page, const TrackRun& run) {
  const std::vector<std::string>& warnings = run.arguments.console.warnings();
  if (warnings.empty()) return;
  page.heading(warnings.size() == 1 ? "Warning" : "Warnings");
  page.warnings(warnings);
}

void add_why_not(HtmlPage& page, const TrackRun& run, const RunStatistics& figures) {
  if (figures.blind.empty()) return;
  page.heading("Where not, and why");
  page.table(blind_table(figures));
  if (!run.record.lost_reasons().empty()) page.table(reasons_table(run.record));
}

void add_path(HtmlPage& page, const TrackRun& run, const Trajectory& truth) {
  const TrackMode mode = run.arguments.method_options().localizer.mode;
  page.heading(mode == TrackMode::kEgo ? "Where the camera was" : "Where the body was");
  page.scene(scene_of_track(run, truth), caption_of_track_scene(run));
  const std::vector<MapDrawing> drawings = draw_path(run, truth);
  page.svg(drawings[0].pictures.front(), drawings[0].caption);
  page.svg(drawings[1].pictures, drawings[1].caption);
  add_picture(page, draw_position(run.record, mode));
  add_picture(page, draw_rotation(run.record, mode));
}

void add_claims(HtmlPage& page, const TrackRun& run) {
  page.heading("How well it is known");
  page.paragraph(
      "What the run itself claims. An honest error is of about this size, and seldom more than twice that; a "
      "wrong camera file, map or tag size makes errors that no sigma knows of.");
  add_picture(page, draw_position_sigma(run.record));
  add_picture(page, draw_rotation_sigma(run.record));
}

void add_tags_and_time(HtmlPage& page, const TrackRun& run, const RunStatistics& figures) {
  page.heading("What was seen");
  page.paragraph(describe_tags(run.record, run.map));
  page.table(tags_of_run_table(run.record, run.map));
  add_picture(page, draw_tags(run.record));
  page.heading("How long it took");
  add_picture(page, draw_latency(run.record, figures));
}

/// A truth that cannot be used is no reason to withhold the rest.
struct Truth {
  std::optional<TruthScore> score;
  std::string why_not;  ///< Empty where there is a score, or no truth.
};

Truth find_truth(const TrackRun& run) {
  try {
    return {score_against_truth(run.arguments, run.camera, run.map, run.record, run.was_interrupted), ""};
  } catch (const Error& error) {
    return {std::nullopt, error.what()};
  }
}

void add_truth(HtmlPage& page, const Truth& truth, const TrackRecord& record) {
  if (truth.score) add_truth_section(page, *truth.score, record);
  if (truth.why_not.empty()) return;
  page.heading("Against the truth");
  page.paragraph(fmt::format("The recording's truth.tum could not be compared: {}", truth.why_not));
}

}  // namespace

void write_track_report(const std::filesystem::path& path, const TrackRun& run) {
  HtmlPage page(fmt::format("Tracking report: {}", input_name(run.arguments)));
  add_warnings(page, run);
  page.heading("In short");
  if (run.record.rows().empty()) {
    page.paragraph("There are no frames, and so no poses.");
  } else {
    const RunStatistics figures = run_statistics(run.record.rows(), run.record.reasons());
    page.paragraph(verdict(run, figures));
    page.table(summary_table(run, figures));
    page.table(status_table(figures));
    page.list(meanings_of_statuses());
    if (const std::string share = describe_map_share(run, figures); !share.empty()) page.paragraph(share);
    add_picture(page, draw_statuses(run.record));
    add_why_not(page, run, figures);
    const Truth truth = find_truth(run);
    add_truth(page, truth, run.record);
    if (run.record.has_pose()) {
      add_path(page, run, truth_to_draw(truth.score));
      add_claims(page, run);
    }
    add_tags_and_time(page, run, figures);
  }
  page.heading("How it was made");
  page.code(run.command_line);
  page.table(settings_table(run));
  write_html_page(path, page);
}

}  // namespace apriltrack::app
