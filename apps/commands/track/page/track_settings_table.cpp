#include <fmt/format.h>

#include "apriltrack/base/version.h"
#include "apriltrack/tracker/blur_tracker.h"
#include "apriltrack/tracker/paper_tracker.h"
#include "track_report_tables.h"

namespace apriltrack::app {
namespace {

std::string describe_camera(const Camera& camera) {
  const std::string size = camera.width > 0 ? fmt::format("{} x {} pixels", camera.width, camera.height)
                                            : std::string("resolution not told");
  return fmt::format("{}, {}", camera.name, size);
}

std::string particles(const MethodOptions& options) {
  if (options.num_particles) return fmt::format("{}", *options.num_particles);
  if (options.name == "blur")
    return fmt::format("{} in each of five rounds", BlurTrackerOptions().num_particles);
  const bool is_printed = options.paper_variant == "printed";
  return fmt::format(
      "{}", PaperTrackerOptions::published(is_printed ? PaperVariant::kPrinted : PaperVariant::kProgram)
                .filter.num_particles);
}

const char* describe_method(const std::string& method) {
  if (method == "pnp") return "pnp: detection plus multi-tag PnP";
  if (method == "paper") return "paper: the seed paper's particle filter";
  return "blur: detected corners and blurred tag patterns";
}

}  // namespace

HtmlTable settings_table(const TrackRun& run) {
  const TrackArguments& arguments = run.arguments;
  const MethodOptions options = arguments.method_options();
  HtmlTable table{{"what", "value"}, {}, ""};
  const auto add = [&](std::string what, std::string value) {
    table.rows.push_back({std::move(what), std::move(value)});
  };
  add("program", std::string("apriltrack ") + version());
  add("input", input_name(arguments));
  add("camera", fmt::format("{} ({})", run.camera_file, describe_camera(run.camera)));
  add("map", fmt::format("{} ({} tags in frame '{}')", run.map_file, run.map.tags.size(), run.map.frame));
  add("mode", arguments.mode == "joint" ? "joint: poses are T_camera_body" : "ego: poses are T_world_camera");
  add("method", describe_method(options.name));
  if (options.name == "paper") add("variant of the paper", options.paper_variant);
  if (options.name != "pnp") add("particles", particles(options));
  if (options.name != "pnp") add("seed", fmt::format("{}", options.seed));
  const SourceOptions& source = arguments.frames.source;
  if (source.rate_hz) add("frames a second", fmt::format("{:g}", *source.rate_hz));
  if (source.skip > 0) add("frames left out at the start", fmt::format("{}", source.skip));
  if (source.step > 1) add("frames used", fmt::format("one of {}", source.step));
  if (source.max_frames) add("frames used at most", fmt::format("{}", *source.max_frames));
  if (!arguments.detections.empty()) return table;
  add("response of the camera", words_of(run.response));
  const DetectorOptions& detector = options.localizer.detector;
  add("threads",
      options.num_threads == 0 ? "one per core, 8 at most" : fmt::format("{}", options.num_threads));
  add("least decision margin", fmt::format("{:g}", detector.min_decision_margin));
  add("most corrected bits",
      detector.max_hamming ? fmt::format("{}", *detector.max_hamming) : "by the family");
  add("search in an image smaller by", fmt::format("{:g}", detector.decimate));
  return table;
}

}  // namespace apriltrack::app
