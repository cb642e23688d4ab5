#include "calibrate_report.h"

#include <fmt/format.h>

#include <span>

#include "apriltrack/report/html_page.h"
#include "calibrate_report_tables.h"
#include "left_out_places.h"
#include "pages/calibrate_scene.h"
#include "pages/constraint_table.h"
#include "pages/map_drawings.h"
#include "pages/residual_drawings.h"

namespace apriltrack::app {
namespace {

std::string title_of(const CalibrateOptions& options) {
  const auto& inputs = options.detections.empty() ? options.inputs : options.detections;
  std::string names;
  for (const std::string& input : inputs) names += (names.empty() ? "" : ", ") + input;
  return "Calibration report: " + names;
}

void add_drawing(HtmlPage& page, const MapDrawing& drawing) {
  if (drawing.pictures.size() == 1) {
    page.svg(drawing.pictures.front(), drawing.caption);
  } else if (!drawing.pictures.empty()) {
    page.svg(drawing.pictures, drawing.caption);
  }
}

/// What must not be overlooked stands above all figures.
void add_warnings(HtmlPage& page, const CalibrateRun& run) {
  std::vector<std::string> warnings = run.options.console.warnings();
  for (const HangingPart& part : run.findings.of_map.hanging) warnings.push_back(part.words);
  if (run.result.cross_validation && run.result.cross_validation->is_in_doubt())
    warnings.push_back(run.result.cross_validation->words);
  if (warnings.empty()) return;
  page.heading(warnings.size() == 1 ? "Warning" : "Warnings");
  page.warnings(warnings);
}

void add_map(HtmlPage& page, const DrawnMap& drawn) {
  page.scene(scene_of_calibration(drawn), caption_of_scene(drawn));
  add_drawing(page, draw_from_above(drawn));
  add_drawing(page, draw_from_sides(drawn));
}

void add_weakness(HtmlPage& page, const CalibrateRun& run) {
  page.heading("What is weak, and what would help");
  const MapAssessment& assessment = run.findings.of_map;
  std::vector<std::string> weak, help;
  for (const WeakDirection& one : assessment.directions) {
    if (one.is_weak) weak.push_back(one.words + ".");
  }
  for (const JoinAdvice& one : run.findings.joining) help.push_back(one.words + ".");
  for (const ViewAdvice& one : assessment.advice) help.push_back(one.words + ".");
  if (run.findings.joint->is_empty()) {
    page.paragraph(
        "Not known: the covariances between the tags of so large a map were not reckoned "
        "(--joint-covariance FILE asks for them).");
  } else if (weak.empty()) {
    page.paragraph("No tag is known much less well than the others, in any direction.");
  }
  page.list(weak);
  if (!help.empty()) {
    page.paragraph(
        "Each piece of advice is reckoned on top of the ones before it, from the places where the camera has "
        "been:");
    page.list(help);
  } else if (!run.findings.joint->is_empty()) {
    page.paragraph("No few pictures would improve any tag much.");
  }
}

void add_residuals(HtmlPage& page, const CalibrateRun& run) {
  page.heading("What the corners leave over");
  MapDrawing maps = draw_residual_maps(run.result.evidence, run.result.rig);
  const MapDrawing histogram = draw_residual_histogram(run.result.evidence);
  maps.pictures.push_back(histogram.pictures.front());
  maps.caption += " " + histogram.caption;
  add_drawing(page, maps);
}

void add_cameras(HtmlPage& page, const CalibrateRun& run) {
  page.heading("Cameras");
  if (run.result.corrections.empty()) {
    page.paragraph("As their file says: no correction was taken.");
  } else {
    page.table(corrections_table(run.result.corrections, "The views agree better with them."));
  }
  if (!run.result.open_corrections.empty())
    page.table(corrections_table(run.result.open_corrections,
                                 "What the views propose besides, but too few frames decide: the map is "
                                 "without it, and its covariances count it."));
}

void add_responses(HtmlPage& page, const CalibrateRun& run) {
  if (run.responses.empty()) return;
  page.heading("The response of the cameras");
  page.table(responses_table(run.responses));
}

void add_refinement(HtmlPage& page, const CalibrateRun& run) {
  if (!run.refinement) return;
  page.heading("Refined on the tags' pictures");
  page.paragraph(words_of_refinement(*run.refinement));
}

void add_constraints(HtmlPage& page, const CalibrateRun& run) {
  if (run.result.constraint_audits.empty()) return;
  page.heading("What was measured beside the images");
  page.paragraph("The map's frame: " + run.result.gauge + ".");
  page.table(constraints_table(run.result.constraint_audits));
}

void add_halves(HtmlPage& page, const CalibrateRun& run) {
  if (!run.result.cross_validation) return;
  const CrossValidation& halves = *run.result.cross_validation;
  page.heading("The recording's two halves against each other");
  if (!halves.why_not.empty()) {
    page.paragraph("Not made: " + halves.why_not + ".");
    return;
  }
  page.paragraph(words_of_halves(halves));
  page.table(halves_table(halves));
}

/// The map, and the parts that no frame joins to it, in one scale of ellipses.
std::vector<DrawnMap> drawn_maps(const CalibrateRun& run) {
  const CalibrationResult& result = run.result;
  std::vector<DrawnMap> all = {{.map = result.map,
                                .evidence = result.evidence,
                                .assessment = run.findings.of_map,
                                .left_out = place_left_out_tags(run),
                                .is_frame_measured = result.is_frame_measured,
                                .is_vertical_measured = result.is_vertical_measured}};
  for (std::size_t i = 0; i < result.other_parts.size(); ++i)
    all.push_back({.map = result.other_parts[i],
                   .evidence = result.evidence_of_other_parts[i],
                   .assessment = run.findings.of_other_parts[i]});
  const double scale = ellipse_scale_for(all);
  for (DrawnMap& drawn : all) drawn.ellipse_scale = scale;
  return all;
}

void add_other_parts(HtmlPage& page, std::span<const DrawnMap> parts) {
  for (const DrawnMap& part : parts) {
    page.heading(fmt::format("A part of its own: {} tags", part.map.tags.size()));
    page.paragraph("No frame ties it to the map. Its gauge is its own, and so are its places.");
    add_drawing(page, draw_from_above(part));
    page.table(tags_table(part.map, part.evidence.joint, part.evidence, part.assessment));
  }
}

}  // namespace

void write_calibrate_report(const std::filesystem::path& path, const CalibrateRun& run) {
  const std::vector<DrawnMap> all = drawn_maps(run);
  const DrawnMap& drawn = all.front();
  HtmlPage page(title_of(run.options));
  add_warnings(page, run);
  page.heading("In short");
  page.paragraph(verdict(run));
  add_map(page, drawn);
  add_weakness(page, run);
  page.heading("Tag by tag");
  page.table(tags_table(run.result.map, *run.findings.joint, run.result.evidence, run.findings.of_map));
  page.heading("How the tags hang together");
  add_drawing(page, draw_links(drawn));
  add_constraints(page, run);
  add_halves(page, run);
  add_residuals(page, run);
  add_cameras(page, run);
  add_responses(page, run);
  add_refinement(page, run);
  add_other_parts(page, std::span(all).subspan(1));
  page.heading("How it was made");
  page.code(run.command_line);
  page.table(calibrate_settings_table(run));
  write_html_page(path, page);
}

std::filesystem::path page_without_map(const std::filesystem::path& report) {
  std::filesystem::path page = report;
  page.replace_extension(".no_map" + report.extension().string());
  return page;
}

void write_failure_report(const std::filesystem::path& path, const std::string& command_line,
                          const CalibrateOptions& options, const std::string& why) {
  HtmlPage page(title_of(options));
  page.heading("No map");
  page.paragraph("The recording gave no map that could be trusted. The reason, and what to do:");
  page.warnings({why});
  if (!options.console.warnings().empty()) {
    page.heading("Warnings");
    page.warnings(options.console.warnings());
  }
  page.heading("How it was tried");
  page.code(command_line);
  write_html_page(path, page);
}

}  // namespace apriltrack::app
