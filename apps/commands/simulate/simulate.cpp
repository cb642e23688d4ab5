#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "apriltrack/base/error.h"
#include "apriltrack/base/parallel.h"
#include "apriltrack/eval/trajectory.h"
#include "apriltrack/io/atomic_file.h"
#include "apriltrack/sim/named_scenes.h"
#include "apriltrack/sim/renderer.h"
#include "apriltrack/sim/streaks.h"
#include "apriltrack/source/sequence_writer.h"
#include "cli/command_help.h"
#include "cli/commands.h"
#include "cli/console.h"
#include "simulate_options.h"
#include "simulate_scene.h"

namespace apriltrack::app {
namespace {

namespace fs = std::filesystem;

/// What stays of a frame once its picture is on the disk.
struct WrittenFrame {
  Timestamp timestamp;
  Pose truth;
  double exposure_s = 0.0;
  double light = 1.0;
  std::optional<double> blur_px;
};

using WrittenFrames = std::vector<std::optional<WrittenFrame>>;

WrittenFrames render_frames(const Renderer& renderer, const SequenceWriter& writer,
                            const SimulateOptions& options) {
  const Scene& scene = renderer.scene();
  WrittenFrames written(scene.num_frames);
  Progress progress(options.console, "rendering", scene.num_frames);
  std::mutex progress_mutex;
  parallel_for(options.num_threads)(scene.num_frames, [&](std::size_t index) {
    if (is_interrupted()) return;
    const RenderedFrame frame = renderer.render(index);
    writer.write_frame(frame.frame());
    written[index] = {frame.timestamp, frame.truth, frame.exposure_s, frame.light,
                      frame_blur_px(scene, frame.timestamp)};
    const std::lock_guard lock(progress_mutex);
    progress.advance();
  });
  return written;
}

/// Truth and, where the lamps flicker, gain: of the frames that are on the disk, and of no others.
void write_truth(const WrittenFrames& written, const Scene& scene, const SequenceWriter& writer) {
  Trajectory truth;
  std::vector<Frame> frames;
  double first_light = 0.0;
  for (const auto& frame : written) {
    if (!frame) continue;
    if (frames.empty()) first_light = frame->light;
    truth.push_back({frame->timestamp, frame->truth});
    Frame row;
    row.timestamp = frame->timestamp;
    row.exposure_s = frame->exposure_s;
    row.gain = frame->light / first_light;
    frames.push_back(row);
  }
  write_tum(writer.folder() / "truth.tum", truth);
  if (scene.flicker.depth > 0.0) writer.write_frames_csv(frames);
}

struct BlurFigures {
  std::size_t num_frames = 0;
  std::size_t num_with_tags = 0;
  std::size_t num_over_10_px = 0;
  std::size_t num_black = 0;
  double max_px = 0.0;
};

/// Tags that no frame shows, as far as directions tell: what stands before a tag is not regarded.
std::vector<std::string> tags_never_in_view(const WrittenFrames& written, const Scene& scene) {
  std::set<TagKey> unseen;
  for (const MapTag& tag : scene.map.tags) unseen.insert(tag.key);
  for (const auto& frame : written) {
    if (!frame) continue;
    for (const TagView& view : tag_views(scene, frame->timestamp)) unseen.erase(view.key);
  }
  std::vector<std::string> names;
  for (const TagKey& key : unseen) names.push_back(to_string(key));
  return names;
}

BlurFigures blur_figures(const WrittenFrames& written, const Scene& scene) {
  BlurFigures figures;
  for (std::size_t i = 0; i < written.size(); ++i) {
    const std::optional<WrittenFrame>& frame = written[i];
    if (!frame) continue;
    ++figures.num_frames;
    figures.num_black += scene.is_blacked_out(i) ? 1 : 0;
    if (!frame->blur_px) continue;
    ++figures.num_with_tags;
    figures.num_over_10_px += *frame->blur_px > 10.0 ? 1 : 0;
    figures.max_px = std::max(figures.max_px, *frame->blur_px);
  }
  return figures;
}

void report(const Scene& scene, const BlurFigures& figures, const std::vector<std::string>& unseen,
            const SimulateOptions& options) {
  const double share = figures.num_with_tags == 0 ? 0.0
                                                  : static_cast<double>(figures.num_over_10_px) /
                                                        static_cast<double>(figures.num_with_tags);
  const nlohmann::json summary = {{"output", options.output},
                                  {"scene", scene.name},
                                  {"mode", scene.truth == TruthKind::kEgo ? "ego" : "joint"},
                                  {"frames", figures.num_frames},
                                  {"frames_asked", scene.num_frames},
                                  {"frames_with_tags", figures.num_with_tags},
                                  {"tags", scene.map.tags.size()},
                                  {"tags_never_in_view", unseen},
                                  {"share_over_10_px", share},
                                  {"max_blur_px", figures.max_px},
                                  {"rate_hz", scene.rate_hz},
                                  {"exposure_s", scene.exposure_s},
                                  {"black_frames", figures.num_black},
                                  {"seed", options.seed},
                                  {"interrupted", figures.num_frames < scene.num_frames}};
  std::string text = fmt::format(
      "{}: {} frames of {}, {} of them with tags in view, {:.0f} % over 10 px of blur, at most {:.1f} px",
      options.output, figures.num_frames,
      options.map.empty() ? fmt::format("scene '{}'", scene.name) : options.map, figures.num_with_tags,
      100.0 * share, figures.max_px);
  if (figures.num_with_tags == 0 && !options.map.empty())
    options.console.warning(fmt::format(
        "no frame shows a tag of {}: is {} in metres, with quaternions in the order x y z w, of {}, and in "
        "the frame of the map?",
        options.map, options.trajectory,
        scene.truth == TruthKind::kEgo ? "the camera's pose in the map (T_world_camera), not its inverse"
                                       : "the body's pose before the camera (T_camera_body)"));
  if (!unseen.empty())
    text += fmt::format("\n{} of {} tags are never in view: {}", unseen.size(), scene.map.tags.size(),
                        fmt::join(unseen, ", "));
  options.console.finish(summary, text);
}

constexpr const char* kMark = "made_by_apriltrack_simulate.txt";

/// Whether --force would take away anything: what a sequence folder has, and pictures.
bool has_recording(const fs::path& folder) {
  std::error_code ignored;
  const bool has_frames =
      fs::is_directory(folder / "frames", ignored) && !fs::is_empty(folder / "frames", ignored);
  return has_frames ||
         std::ranges::any_of(std::array{"camera.yaml", "map.yaml", "frames.csv", "truth.tum"},
                             [&](const char* name) { return fs::exists(folder / name, ignored); });
}

void check_folder(const SimulateOptions& options) {
  std::error_code ignored;
  const fs::path folder = options.output;
  const bool is_full = fs::is_directory(folder, ignored) && !fs::is_empty(folder, ignored);
  if (is_full && !options.is_forced)
    throw io_error(
        options.output,
        "is not empty: name a new folder, or give --force to replace a recording that simulate made");
  if (is_full && has_recording(folder) && !fs::exists(folder / kMark, ignored))
    throw invalid_input("--force",
                        fmt::format("'{}' holds a recording that simulate did not make (it has no {}): "
                                    "name a new folder",
                                    options.output, kMark));
}

WrittenFrames write_recording(const Scene& scene, const SequenceWriter& writer,
                              const SimulateOptions& options) {
  // First of all, so that a run which was ended in between can be replaced, too.
  write_file_atomically(
      writer.folder() / kMark,
      "The recording here was made by `apriltrack simulate`, which replaces it with --force.\n");
  CameraRig rig;
  rig.cameras.push_back(scene.camera);
  writer.write_camera(rig);
  writer.write_map(scene.map);
  const Renderer renderer(scene, {.seed = options.seed});
  const WrittenFrames written = render_frames(renderer, writer, options);
  write_truth(written, scene, writer);
  return written;
}

/// A recording without its end and its truth is none: it is taken away where the disk is full.
WrittenFrames write_recording_or_none(const Scene& scene, const SequenceWriter& writer,
                                      const SimulateOptions& options) {
  try {
    return write_recording(scene, writer, options);
  } catch (const Error&) {
    std::error_code ignored;
    fs::remove(writer.folder() / kMark, ignored);
    writer.discard();
    throw;
  }
}

void simulate(const SimulateOptions& options) {
  const Scene scene = configured_scene(options);
  check_folder(options);
  const SequenceWriter writer(options.output, options.is_forced);
  const WrittenFrames written = write_recording_or_none(scene, writer, options);
  const BlurFigures figures = blur_figures(written, scene);
  if (figures.num_frames < scene.num_frames) {
    options.console.warning(fmt::format("interrupted: {} of {} frames are in {}, with their truth",
                                        figures.num_frames, scene.num_frames, options.output));
  }
  if (figures.num_frames == 0) throw no_result("simulate", "interrupted before the first frame was rendered");
  report(scene, figures, tags_never_in_view(written, scene), options);
}

CommandHelp help() {
  std::string details = "Scenes:\n";
  for (const SceneName& scene : named_scenes())
    details += fmt::format("  {:<12} {}\n", scene.name, scene.summary);
  details +=
      "\nOne's own tags and lens, along a path such as track writes:\n"
      "  apriltrack simulate --map map.yaml --camera camera.yaml --trajectory path.tum --output film\n"
      "\nThe folder gets frames/, camera.yaml, map.yaml and truth.tum (the pose at the middle of each "
      "exposure).\n\nHarder film, with every scene and together:\n"
      "  --light 0.05                            few photons\n"
      "  --occlude 0.35                          a hand before the lens\n"
      "  --blackout 90:9 --blackout 180:45       black frames\n"
      "  --flicker 0.5                           lamps on alternating current\n"
      "  --speed 0                               a camera that stands still";
  return {"Renders a recording with true motion blur and exact truth.",
          "apriltrack simulate --scene room --output room --seed 7", details};
}

}  // namespace

void add_simulate_command(CLI::App& app) {
  auto options = std::make_shared<SimulateOptions>();
  CLI::App& command = add_command(app, "simulate", help());
  add_simulate_options(command, *options);
  command.callback([options] { simulate(*options); });
}

}  // namespace apriltrack::app
