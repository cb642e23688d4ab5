#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <system_error>

#include "apriltrack/base/error.h"
#include "apriltrack/eval/evaluate_frame_log.h"
#include "apriltrack/eval/evaluate_trajectory.h"
#include "cli/command_help.h"
#include "cli/commands.h"
#include "evaluate_report.h"
#include "files/inputs.h"
#include "files/map_input.h"
#include "files/pose_choice.h"
#include "files/trajectory_input.h"

namespace apriltrack::app {
namespace {

namespace fs = std::filesystem;

const CommandHelp kEvaluateHelp = {
    "Scores a trajectory against the truth.",
    "apriltrack evaluate --truth room --estimate camera.tum --frames-csv frames.csv",
    "Position and rotation (not aligned unless asked), coverage, and the corner error in pixels at\n"
    "mid-exposure by blur. A frame without a pose counts as a failure."};

struct EvaluateOptions {
  std::string truth;
  std::string estimate;
  std::string mode = "ego";
  std::string camera;
  std::string camera_name;
  std::string map;
  MapInputOptions map_input;
  std::string frames_csv;
  PoseChoices pose_choices;
  bool align = false;
  Console console;
};

/// --truth is a sequence folder, which brings its own camera and map, or a trajectory.
struct Inputs {
  fs::path truth;
  fs::path camera;
  fs::path map;
};

Inputs find_inputs(const EvaluateOptions& options) {
  Inputs inputs{options.truth, options.camera, options.map};
  if (fs::is_directory(inputs.truth)) {
    const fs::path folder = inputs.truth;
    inputs.truth = folder / "truth.tum";
    if (inputs.camera.empty() && fs::exists(folder / "camera.yaml")) inputs.camera = folder / "camera.yaml";
    if (inputs.map.empty() && fs::exists(folder / "map.yaml")) inputs.map = folder / "map.yaml";
  }
  const bool asked_for_one = !options.camera.empty() || !options.camera_name.empty() || !options.map.empty();
  if (asked_for_one && (inputs.camera.empty() || inputs.map.empty())) {
    throw invalid_input(
        inputs.map.empty() ? "--map" : "--camera",
        "is missing: corner errors need the camera and the map; leave out both to score poses only");
  }
  return inputs;
}

std::optional<CornerScene> read_scene(const Inputs& inputs, const EvaluateOptions& options) {
  if (inputs.camera.empty() || inputs.map.empty()) {
    options.console.info("no camera and map: poses are scored, corner errors are not");
    return std::nullopt;
  }
  const Camera camera = read_camera(inputs.camera, options.camera_name, options.console);
  const bool has_images = fs::is_directory(options.truth);
  return CornerScene{has_images ? with_resolution_of_images(camera, options.truth) : camera,
                     read_map_input(inputs.map.string(), options.map_input, options.console)};
}

std::ptrdiff_t count_frames_with_tags(const Trajectory& truth, const CornerScene& scene,
                                      TrajectoryKind kind) {
  return std::count_if(truth.begin(), truth.end(), [&](const TimedPose& frame) {
    const bool is_joint = kind == TrajectoryKind::kJoint;
    return !visible_tags(scene, is_joint ? frame.pose : frame.pose.inverse()).empty();
  });
}

/// Read the wrong way round, most truths look away from their tags in most frames. Empty where nothing speaks
/// against the mode.
std::string mode_hint(const Trajectory& truth, const CornerScene* scene, TrajectoryKind kind) {
  if (!scene || scene->camera.width <= 0 || scene->camera.height <= 0) return "";
  const bool is_ego = kind == TrajectoryKind::kEgo;
  const auto with_tags = count_frames_with_tags(truth, *scene, kind);
  const auto with_tags_otherwise =
      count_frames_with_tags(truth, *scene, is_ego ? TrajectoryKind::kJoint : TrajectoryKind::kEgo);
  if (2 * with_tags >= with_tags_otherwise) return "";
  return fmt::format(
      "as --mode {}, the truth shows tags in {} of {} frames, as --mode {} in {}: try --mode {}",
      is_ego ? "ego" : "joint", with_tags, truth.size(), is_ego ? "joint" : "ego", with_tags_otherwise,
      is_ego ? "joint" : "ego");
}

/// The library knows of no files: whoever mixed two recordings up wants to see which.
Error naming_files(const Error& error, const std::string& scored, const fs::path& truth, std::string hint) {
  if (!hint.empty()) hint = "; " + hint;
  return Error(error.kind(), scored + " against " + truth.string(), error.what() + hint);
}

/// Poses in frames of which the truth, so read, shows no tag.
int poses_without_tags(const TrajectoryEvaluation& evaluation, const Trajectory& estimate) {
  const auto with_tags = std::ranges::count_if(
      evaluation.frames, [](const FrameScore& frame) { return frame.error.has_value(); });
  return static_cast<int>(estimate.size()) - evaluation.unmatched_estimates - static_cast<int>(with_tags);
}

/// Only a tag in view gives poses, but for the few predicted ones: an estimate with many where the truth
/// shows no tag, and hardly any of these as the other mode reads it, speaks for that mode. A wrong mode can
/// show tags in most frames, and a trajectory read the wrong way round on both sides has no error.
std::string mode_hint_of_poses(const TrajectoryEvaluation& evaluation, const Trajectory& truth,
                               const Trajectory& estimate, const CornerScene& scene, TrajectoryKind kind) {
  constexpr int kFew = 3;
  constexpr int kManyOf = 20;  // one in so many
  constexpr int kTimesFewer = 4;
  const int matched = static_cast<int>(estimate.size()) - evaluation.unmatched_estimates;
  const int blind = poses_without_tags(evaluation, estimate);
  if (blind < kFew || kManyOf * blind < matched) return "";
  const bool is_ego = kind == TrajectoryKind::kEgo;
  const TrajectoryKind other = is_ego ? TrajectoryKind::kJoint : TrajectoryKind::kEgo;
  if (count_frames_with_tags(truth, scene, other) == 0) return "";
  const int blind_otherwise =
      poses_without_tags(evaluate_trajectory(truth, estimate, &scene, {other}), estimate);
  if (kTimesFewer * blind_otherwise > blind) return "";
  return fmt::format(
      "as --mode {}, the truth shows no tag in {} of the {} frames that have a pose, as --mode {} in {}: try "
      "--mode {}",
      is_ego ? "ego" : "joint", blind, matched, is_ego ? "joint" : "ego", blind_otherwise,
      is_ego ? "joint" : "ego");
}

/// Two recordings may begin at the same time, as those do whose times are counted from nought.
void warn_of_another_recording(const TrajectoryEvaluation& evaluation, const EvaluateOptions& options,
                               const fs::path& truth) {
  constexpr double kFar_px = 100.0;
  std::ptrdiff_t scored = 0;
  std::ptrdiff_t far = 0;
  for (const FrameScore& frame : evaluation.frames) {
    if (!frame.corner_error_px) continue;
    ++scored;
    if (*frame.corner_error_px > kFar_px) ++far;
  }
  if (2 * far <= scored) return;
  options.console.warning(fmt::format(
      "{} of {} poses are over {:g} px off: does {} belong to {}?{}", far, scored, kFar_px, options.estimate,
      truth.string(), options.align ? "" : " And is its map frame that of the truth (else --align)?"));
}

/// A truth with a rate of its own, as of motion capture, meets some frames only, and has more poses than
/// those.
void warn_of_other_times(const TrajectoryEvaluation& evaluation, const EvaluateOptions& options,
                         std::size_t num_estimates, const fs::path& truth, std::size_t num_truth) {
  if (evaluation.unmatched_estimates == 0) return;
  options.console.warning(fmt::format(
      "{} of the {} poses of {} are left out, for {} has none within 1 ms of their times, and `coverage` "
      "counts "
      "the truth's {} poses, not the frames: give a truth that has a pose at the time of every frame",
      evaluation.unmatched_estimates, num_estimates, options.estimate, truth.string(), num_truth));
}

TrajectoryEvaluation evaluate(const EvaluateOptions& options, const Inputs& inputs) {
  check_pose_choices(options.pose_choices, {inputs.truth.string(), options.estimate});
  const auto read = [&](const std::string& role, const std::string& path) {
    return read_trajectory_input(path, {.bag = choice_for(role, path, options.pose_choices), .read = {}},
                                 options.console)
        .trajectory;
  };
  const Trajectory truth = read("truth", inputs.truth.string());
  const Trajectory estimate = read("estimate", options.estimate);
  const std::optional<CornerScene> known_scene = read_scene(inputs, options);
  const CornerScene* scene = known_scene ? &*known_scene : nullptr;
  const TrajectoryKind kind = options.mode == "joint" ? TrajectoryKind::kJoint : TrajectoryKind::kEgo;
  std::string hint = mode_hint(truth, scene, kind);
  try {
    TrajectoryEvaluation evaluation = evaluate_trajectory(truth, estimate, scene, {kind, options.align});
    if (hint.empty() && scene) hint = mode_hint_of_poses(evaluation, truth, estimate, *scene, kind);
    if (!hint.empty()) options.console.warning(hint);
    warn_of_another_recording(evaluation, options, inputs.truth);
    warn_of_other_times(evaluation, options, estimate.size(), inputs.truth, truth.size());
    return evaluation;
  } catch (const Error& error) {
    throw naming_files(error, options.estimate, inputs.truth, hint);
  }
}

FrameLogEvaluation evaluate_log(const EvaluateOptions& options, const Inputs& inputs,
                                const TrajectoryEvaluation& evaluation) {
  const std::vector<FrameLogRow> rows = read_frame_log(options.frames_csv);
  try {
    const FrameLogEvaluation log = evaluate_frame_log(evaluation, rows);
    if (log.claimed_without_pose > 0)
      options.console.warning(
          fmt::format("{} claims poses in {} frames in which {} has none: are they of the same run?",
                      options.frames_csv, log.claimed_without_pose, options.estimate));
    return log;
  } catch (const Error& error) {
    throw naming_files(error, options.frames_csv, inputs.truth, "");
  }
}

void run_evaluate(const EvaluateOptions& options) {
  const Inputs inputs = find_inputs(options);
  const TrajectoryEvaluation evaluation = evaluate(options, inputs);
  nlohmann::json summary = to_json(evaluation);
  std::error_code ignored;  // a pipe has no place among the folders
  const fs::path place = fs::weakly_canonical(options.truth, ignored);
  summary["sequence"] = (ignored ? fs::path(options.truth) : place).filename().string();
  std::string text = to_text(evaluation);
  if (!options.frames_csv.empty()) {
    const FrameLogEvaluation log = evaluate_log(options, inputs, evaluation);
    add_log(summary, log);
    text += to_text(log);
  }
  text.pop_back();  // finish() ends the line
  options.console.finish(summary, text);
}

}  // namespace

void add_evaluate_command(CLI::App& app) {
  CLI::App& command = add_command(app, "evaluate", kEvaluateHelp);
  auto options = std::make_shared<EvaluateOptions>();
  command
      .add_option(
          "--truth", options->truth,
          "Sequence folder, whose truth.tum, camera.yaml and map.yaml are taken, or a trajectory: TUM, "
          "EuRoC's csv, KITTI's poses with their times beside them, or a bag's")
      ->required();
  command.add_option("--estimate", options->estimate, "Trajectory that is scored, of any of these formats")
      ->required();
  add_pose_choice_options(command, options->pose_choices);
  command.add_option("--mode", options->mode, "ego: poses are T_world_camera; joint: T_camera_body")
      ->check(CLI::IsMember({"ego", "joint"}))
      ->capture_default_str();
  command.add_option("--camera", options->camera, "Camera file, for corner errors");
  command.add_option("--camera-name", options->camera_name,
                     "Which camera of a rig's file, such as cam1 (default: the first)");
  command.add_option("--map", options->map, "True tag map, for corner errors");
  add_map_input_options(command, options->map_input);
  command.add_option(
      "--frames-csv", options->frames_csv,
      "Frame log of the tracker: adds statuses, latency, silent failures, honesty of the covariance");
  command.add_flag("--align", options->align, "Bring the estimate onto the truth by one rigid motion first");
  options->console.add_options(command);
  command.callback([options] { run_evaluate(*options); });
}

}  // namespace apriltrack::app
