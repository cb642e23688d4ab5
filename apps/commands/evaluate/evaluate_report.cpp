#include "evaluate_report.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "apriltrack/base/degrees.h"
#include "apriltrack/eval/statistics.h"
#include "pages/json_units.h"

namespace apriltrack::app {
namespace {

using nlohmann::json;

json rounded(const std::optional<double>& value, int decimals) {
  if (!value) return nullptr;
  return round_to_decimals(*value, decimals);
}

json to_json(const ErrorSummary& summary) {
  return {{"frames", summary.frames},
          {"coverage", round_to_decimals(summary.coverage, 4)},
          {"success_5px", rounded(summary.success_5px, 4)},
          {"median_px", rounded(summary.median_px, 4)},
          {"p95_px", rounded(summary.p95_px, 4)},
          {"position_rmse_m", rounded(summary.position_rmse_m, 6)},
          {"rotation_rmse_rad", rounded(summary.rotation_rmse_rad, 7)},
          {"position_median_m", rounded(summary.position_median_m, 6)},
          {"rotation_median_rad", rounded(summary.rotation_median_rad, 7)}};
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
  return {{"position_m", {{"x", t.x()}, {"y", t.y()}, {"z", t.z()}}},
          {"position", {{"x", t.x()}, {"y", t.y()}, {"z", t.z()}}},  // as 0.1 called it, until 0.3
          {"orientation", {{"x", q.x()}, {"y", q.y()}, {"z", q.z()}, {"w", q.w()}}}};
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

}  // namespace

json to_json(const TrajectoryEvaluation& evaluation) {
  json out = to_json(evaluation.overall);
  out["by_blur_px"] = blur_json(evaluation.by_blur);
  out["truth_frames"] = evaluation.truth_frames;
  out["unmatched_estimates"] = evaluation.unmatched_estimates;
  out["aligned"] = evaluation.T_truth_estimate.has_value();
  if (evaluation.T_truth_estimate) out["T_truth_estimate"] = to_json(*evaluation.T_truth_estimate);
  out["ate_m"] = rounded(evaluation.aligned_position_rmse_m, 6);
  if (const auto& relative = evaluation.relative) {
    out["rpe_1_frame"] = {{"pairs", relative->pairs},
                          {"position_rmse_m", rounded(relative->position_rmse_m, 6)},
                          {"rotation_rmse_rad", rounded(relative->rotation_rmse_rad, 7)}};
  }
  return with_older_units(std::move(out));
}

void add_log(json& out, const FrameLogEvaluation& log) {
  out["status"] = log.statuses;
  out["claimed_good"] = log.claimed_good;
  if (log.claimed_good_but_over_10px) out["claimed_good_but_over_10px"] = *log.claimed_good_but_over_10px;
  out["claimed_share_of_frames"] = round_to_decimals(log.claimed_share_of_frames, 4);
  if (log.latency_p50_ms)
    out["latency_ms"] = {{"p50", rounded(log.latency_p50_ms, 3)}, {"p99", rounded(log.latency_p99_ms, 3)}};
  out["judges_covariances"] = log.judges_covariances;
  if (log.mean_squared_position_error_over_sigma2)
    out["mean_squared_position_error_over_sigma2"] = rounded(log.mean_squared_position_error_over_sigma2, 3);
  if (log.nees_over_6_mean)
    out["nees_over_6"] = {{"mean", rounded(log.nees_over_6_mean, 3)},
                          {"median", rounded(log.nees_over_6_median, 3)}};
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
  if (!log.judges_covariances) {
    text +=
        "\nsigmas and covariances are not judged: they are of poses in the map's frame, which --align "
        "leaves; "
        "judge them without --align, with a map in the truth's frame";
  }
  return text + "\n";
}

}  // namespace apriltrack::app
