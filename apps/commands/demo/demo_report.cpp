#include "demo_report.h"

#include <fmt/format.h>

#include "apriltrack/base/degrees.h"
#include "apriltrack/eval/compare_maps.h"
#include "apriltrack/report/html_page.h"
#include "cli/command_line.h"
#include "demo_charts.h"
#include "demo_paper.h"
#include "demo_picture.h"

namespace apriltrack::app {
namespace {

void add_calibration(HtmlPage& page, const DemoFiles& files) {
  const MapComparison map =
      compare_maps(read_tag_map(files.gentle() / "map.yaml"), read_tag_map(files.calibrated_map()));
  page.heading("Calibration");
  page.paragraph(
      fmt::format("{} of {} tags mapped from the gentle recording's images; against the exact map {:.2f} mm "
                  "and {:.3f} degrees off (root mean square), after the best rigid motion.",
                  map.tags.size(), map.tags.size() + map.missing.size(), 1e3 * map.position_m.rms,
                  kDegPerRad * map.rotation_rad.rms));
}

void add_scene(HtmlPage& page, const DemoFiles& files, const DemoScene& scene,
               const std::vector<DemoScore>& scores) {
  const auto over_time = files.picture(fmt::format("{}_error_over_time", scene.name));
  const auto against_blur = files.picture(fmt::format("{}_error_against_blur", scene.name));
  draw_error_over_time(over_time, scene, scores);
  draw_error_against_blur(against_blur, scene, scores);
  page.heading(scene.name);
  page.paragraph(fmt::format("{}.", scene.story));
  page.picture(
      over_time,
      "Mean distance of the visible tags' corners from where they truly are, at mid-exposure. A ring "
      "for each of pnp's poses, over the lines of the others, which break off where they have none.");
  page.picture(
      against_blur,
      "Blur is the longest path of a visible corner during the exposure, from the exact motion. "
      "The blur tracker's predicted poses, which nothing in their frame confirms, have marks of their own.");
  page.video(files.video(scene),
             "Every mapped tag outlined where the blur tracker puts it. Green: the pose rests on a "
             "detection in this frame; blue: on the pixels alone; orange: predicted; red: lost. Without "
             "an outline: clutter that looks like tags, and tags seen too obliquely to compare.");
}

void add_detection(HtmlPage& page, const DemoFiles& files) {
  const DemoScene& room = kDemoScenes.front();
  const auto picture = files.picture("blindness");
  draw_blindness_picture(files.recording(room), files.trajectory(room, "pnp"), picture);
  page.heading("Where detection goes blind");
  page.picture(picture, "The room's frames by detection alone.");
}

void add_paper(HtmlPage& page, const DemoOptions& options, const DemoFiles& files,
               const std::vector<DemoScore>& scores) {
  const auto patches = files.picture("paper_patches"), cloud = files.picture("paper_cloud");
  const std::string which = draw_paper_pictures(files, scores, options.seed, patches, cloud);
  page.heading("Inside the paper's filter");
  page.picture(patches, "What the likelihood compares with: figure 3 of the paper, from the bundle.");
  page.picture(
      cloud,
      fmt::format("The bundle's particles {}: figure 5 of the paper. Points are translucent: dark where they "
                  "crowd, or weigh much.",
                  which));
}

/// Every option with its value, so that the page can be made again.
std::string command_line(const DemoOptions& options) {
  return fmt::format("apriltrack demo --output {} --seed {} --frames {} --threads {}",
                     shell_line({options.output}), options.seed, options.num_frames, options.threads);
}

}  // namespace

void write_demo_report(const DemoOptions& options, const DemoFiles& files,
                       const std::vector<DemoScore>& scores) {
  HtmlPage page("AprilTrack: the pose through motion blur");
  page.paragraph(
      "Everything here was rendered, calibrated, tracked and measured by one command, against the "
      "simulator's exact truth; the trackers saw images only.");
  page.code(command_line(options));
  const DemoTable table = tabulate(scores);
  page.table(
      {table.header, table.rows,
       fmt::format("Claimed: frames with status detected or tracked. {} Claimed, over 10 px: claimed poses "
                   "that are wrong. ms: median of a frame, all threads at work beside it.",
                   explain_blur_columns())});
  add_calibration(page, files);
  for (const DemoScene& scene : kDemoScenes) add_scene(page, files, scene, scores);
  add_detection(page, files);
  add_paper(page, options, files, scores);
  write_html_page(files.report(), page);
}

}  // namespace apriltrack::app
