#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>

#include "apriltrack/base/error.h"
#include "apriltrack/eval/evaluate_frame_log.h"
#include "apriltrack/eval/evaluate_trajectory.h"
#include "apriltrack/eval/statistics.h"
#include "commands.h"
#include "console.h"

namespace apriltrack::app {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr double kDegPerRad = 180.0 / std::numbers::pi;

struct EvaluateOptions {
  std::string truth;
  std::string estimate;
  std::string mode = "ego";
  std::string camera;
  std::string camera_name;
  std::string map;
  std::string frames_csv;
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
  const bool asked_for_one = !options.camera.empty() || !options.map.empty();
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
  const CameraRig rig = read_cameras(inputs.camera);
  const Camera& camera = options.camera_name.empty() ? rig.cameras.front() : rig.find(options.camera_name);
  return CornerScene{camera, read_tag_map(inputs.map)};
}

json rounded(const std::optional<double>& value, int decimals, double factor = 1.0) {
  if (!value) return nullptr;
  return round_to_decimals(factor * *value, decimals);
}

json to_json(const ErrorSummary& summary) {
  return {{"frames", summary.frames},
          {"coverage", round_to_decimals(summary.coverage, 4)},
          {"success_5px", rounded(summary.success_5px, 4)},
          {"median_px", rounded(summary.median_px, 4)},
          {"p95_px", rounded(summary.p95_px, 4)},
          {"position_rmse_mm", rounded(summary.position_rmse_m, 3, 1e3)},
          {"rotation_rmse_deg", rounded(summary.rotation_rmse_rad, 4, kDegPerRad)},
          {"position_median_mm", rounded(summary.position_median_m, 3, 1e3)},
          {"rotation_median_deg", rounded(summary.rotation_median_rad, 4, kDegPerRad)}};
}

std::string bin_name(const BlurBin& bin) {
  return std::isinf(bin.to_px) ? fmt::format("{}-", bin.from_px)
                               : fmt::format("{}-{}", bin.from_px, bin.to_px);
}

json blur_json(const std::vector<BlurBin>& bins) {
  json by_blur = json::object();
  for (const BlurBin& bin : bins) {
    const json all = to_json(bin.summary);
    for (const char* key : {"frames", "coverage", "success_5px", "median_px", "p95_px"})
      by_blur[bin_name(bin)][key] = all[key];
  }
  return by_blur;
}

json to_json(const Pose& pose) {
  const Eigen::Vector3d& t = pose.translation();
  const Eigen::Quaterniond& q = pose.rotation();
  return {{"position", {{"x", t.x()}, {"y", t.y()}, {"z", t.z()}}},
          {"orientation", {{"x", q.x()}, {"y", q.y()}, {"z", q.z()}, {"w", q.w()}}}};
}

json to_json(const TrajectoryEvaluation& evaluation) {
  json out = to_json(evaluation.overall);
  out["by_blur_px"] = blur_json(evaluation.by_blur);
  out["truth_frames"] = evaluation.truth_frames;
  out["unmatched_estimates"] = evaluation.unmatched_estimates;
  out["aligned"] = evaluation.T_truth_estimate.has_value();
  if (evaluation.T_truth_estimate) out["T_truth_estimate"] = to_json(*evaluation.T_truth_estimate);
  out["ate_mm"] = rounded(evaluation.aligned_position_rmse_m, 3, 1e3);
  if (const auto& relative = evaluation.relative) {
    out["rpe_1_frame"] = {{"pairs", relative->pairs},
                          {"position_rmse_mm", rounded(relative->position_rmse_m, 3, 1e3)},
                          {"rotation_rmse_deg", rounded(relative->rotation_rmse_rad, 4, kDegPerRad)}};
  }
  return out;
}

void add_log(json& out, const FrameLogEvaluation& log) {
  out["status"] = log.statuses;
  out["claimed_good"] = log.claimed_good;
  if (log.claimed_good_but_over_10px) out["claimed_good_but_over_10px"] = *log.claimed_good_but_over_10px;
  out["claimed_share_of_frames"] = round_to_decimals(log.claimed_share_of_frames, 4);
  if (log.latency_p50_ms)
    out["latency_ms"] = {{"p50", rounded(log.latency_p50_ms, 3)}, {"p99", rounded(log.latency_p99_ms, 3)}};
  if (log.mean_squared_position_error_over_sigma2)
    out["mean_squared_position_error_over_sigma2"] = rounded(log.mean_squared_position_error_over_sigma2, 3);
  if (log.nees_over_6_mean)
    out["nees_over_6"] = {{"mean", rounded(log.nees_over_6_mean, 3)},
                          {"median", rounded(log.nees_over_6_median, 3)}};
}

std::string cell(const std::optional<double>& value, int decimals, double factor = 1.0) {
  return value ? fmt::format("{:.{}f}", factor * *value, decimals) : "-";
}

std::string percent(const std::optional<double>& share) {
  return share ? fmt::format("{:.1f} %", 100.0 * *share) : "-";
}

std::string row(const std::string& name, const ErrorSummary& s) {
  return fmt::format("{:<12}{:>8}{:>11}{:>10}{:>11}{:>11}{:>12}{:>12}\n", name, s.frames, percent(s.coverage),
                     percent(s.success_5px), cell(s.median_px, 3), cell(s.p95_px, 3),
                     cell(s.position_rmse_m, 2, 1e3), cell(s.rotation_rmse_rad, 3, kDegPerRad));
}

std::string to_text(const TrajectoryEvaluation& evaluation) {
  std::string text = evaluation.T_truth_estimate
                         ? "estimate ALIGNED onto the truth by one rigid motion first\n"
                         : "not aligned: both trajectories in their own frames\n";
  text += fmt::format("{:<12}{:>8}{:>11}{:>10}{:>11}{:>11}{:>12}{:>12}\n", "blur [px]", "frames", "with pose",
                      "< 5 px", "median px", "95 % px", "RMS [mm]", "RMS [deg]");
  for (const BlurBin& bin : evaluation.by_blur) text += row(bin_name(bin), bin.summary);
  text += row("all", evaluation.overall);
  text += fmt::format("medians: {} mm, {} deg; after the best rigid motion (ATE): {} mm RMS\n",
                      cell(evaluation.overall.position_median_m, 2, 1e3),
                      cell(evaluation.overall.rotation_median_rad, 3, kDegPerRad),
                      cell(evaluation.aligned_position_rmse_m, 2, 1e3));
  if (const auto& relative = evaluation.relative) {
    text += fmt::format("from frame to frame (RPE): {:.2f} mm, {:.3f} deg RMS over {} pairs\n",
                        1e3 * relative->position_rmse_m, kDegPerRad * relative->rotation_rmse_rad,
                        relative->pairs);
  }
  if (evaluation.unmatched_estimates > 0)
    text += fmt::format("{} poses of the estimate have no true frame within 1 ms\n",
                        evaluation.unmatched_estimates);
  return text;
}

std::string to_text(const FrameLogEvaluation& log) {
  std::string text = "statuses:";
  for (const auto& [status, count] : log.statuses) text += fmt::format(" {} {}", count, status);
  text +=
      fmt::format("\nclaimed good: {} frames ({})", log.claimed_good, percent(log.claimed_share_of_frames));
  if (log.claimed_good_but_over_10px)
    text += fmt::format("; silent failures among them (over 10 px): {}", *log.claimed_good_but_over_10px);
  if (log.latency_p50_ms)
    text += fmt::format("\nlatency: {:.2f} ms median, {:.2f} ms in 99 %", *log.latency_p50_ms,
                        *log.latency_p99_ms);
  if (log.nees_over_6_mean) {
    text += fmt::format("\nnormalised error squared over 6 (1 = honest): mean {:.3f}, median {:.3f}",
                        *log.nees_over_6_mean, *log.nees_over_6_median);
  }
  if (log.mean_squared_position_error_over_sigma2) {
    text += fmt::format("\nposition error squared over sigma squared (1 = honest): mean {:.3f}",
                        *log.mean_squared_position_error_over_sigma2);
  }
  return text + "\n";
}

void run_evaluate(const EvaluateOptions& options) {
  const Inputs inputs = find_inputs(options);
  const Trajectory truth = read_tum(inputs.truth);
  const Trajectory estimate = read_tum(options.estimate);
  if (truth.empty()) throw no_result(inputs.truth.string(), "has no pose");
  const std::optional<CornerScene> scene = read_scene(inputs, options);
  const TrajectoryKind kind = options.mode == "joint" ? TrajectoryKind::kJoint : TrajectoryKind::kEgo;
  const TrajectoryEvaluation evaluation =
      evaluate_trajectory(truth, estimate, scene ? &*scene : nullptr, {kind, options.align});
  json summary = to_json(evaluation);
  summary["sequence"] = fs::weakly_canonical(options.truth).filename().string();
  std::string text = to_text(evaluation);
  if (!options.frames_csv.empty()) {
    const FrameLogEvaluation log = evaluate_frame_log(evaluation, read_frame_log(options.frames_csv));
    add_log(summary, log);
    text += to_text(log);
  }
  text.pop_back();  // finish() ends the line
  options.console.finish(summary, text);
}

}  // namespace

void add_evaluate_command(CLI::App& app) {
  auto* command = app.add_subcommand(
      "evaluate",
      "Example: apriltrack evaluate --truth room --estimate out.tum --frames-csv out.csv\n\n"
      "Scores a trajectory against the truth: position and rotation (not aligned unless asked), coverage, "
      "and the\n"
      "corner error in pixels at mid-exposure by blur. A frame without a pose counts as a failure.");
  auto options = std::make_shared<EvaluateOptions>();
  command
      ->add_option("--truth", options->truth,
                   "Sequence folder, whose truth.tum, camera.yaml and map.yaml are taken, or a TUM file")
      ->required();
  command->add_option("--estimate", options->estimate, "TUM file that is scored")->required();
  command->add_option("--mode", options->mode, "ego: poses are T_world_camera; joint: T_camera_body")
      ->check(CLI::IsMember({"ego", "joint"}))
      ->capture_default_str();
  command->add_option("--camera", options->camera, "Camera file, for corner errors");
  command->add_option("--camera-name", options->camera_name,
                      "Which camera of a rig's file, such as cam1 (default: the first)");
  command->add_option("--map", options->map, "True tag map, for corner errors");
  command->add_option(
      "--frames-csv", options->frames_csv,
      "Frame log of the tracker: adds statuses, latency, silent failures, honesty of the covariance");
  command->add_flag("--align", options->align, "Bring the estimate onto the truth by one rigid motion first");
  options->console.add_options(*command);
  command->callback([options] { run_evaluate(*options); });
}

}  // namespace apriltrack::app
