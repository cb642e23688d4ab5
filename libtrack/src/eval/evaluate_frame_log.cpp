#include "apriltrack/eval/evaluate_frame_log.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <cmath>
#include <unordered_map>

#include "apriltrack/base/error.h"
#include "apriltrack/eval/statistics.h"

namespace apriltrack {
namespace {

using FramesByTime = std::unordered_map<std::int64_t, const FrameScore*>;

FramesByTime index_by_time(const std::vector<FrameScore>& frames) {
  FramesByTime by_time;
  for (const FrameScore& frame : frames) by_time.emplace(frame.timestamp.ns, &frame);
  return by_time;
}

void check_same_recording(const FramesByTime& frames, const TrajectoryEvaluation& evaluation,
                          const std::vector<FrameLogRow>& log) {
  if (log.empty()) throw no_result("frame log", "has no row");
  for (const FrameLogRow& row : log) {
    if (frames.contains(row.timestamp.ns)) return;
  }
  throw no_result(
      "frame log",
      fmt::format(
          "none of its {} rows has the time of a scored frame: it runs from {} to {} ns, those frames "
          "from {} to {} ns; is it of the same recording as the truth?",
          log.size(), log.front().timestamp.ns, log.back().timestamp.ns,
          evaluation.frames.front().timestamp.ns, evaluation.frames.back().timestamp.ns));
}

double normalised_error(const FrameLogRow& row, const PoseError& error) {
  const double value =
      error.xi_estimate_truth.dot(row.covariance->partialPivLu().solve(error.xi_estimate_truth)) / 6.0;
  if (!std::isfinite(value)) {
    throw invalid_input(fmt::format("frame log, frame {}", row.timestamp.ns),
                        "cov_00 ... cov_55: the covariance of a claimed pose has no inverse");
  }
  return value;
}

}  // namespace

FrameLogEvaluation evaluate_frame_log(const TrajectoryEvaluation& evaluation,
                                      const std::vector<FrameLogRow>& log) {
  const FramesByTime frames = index_by_time(evaluation.frames);
  check_same_recording(frames, evaluation, log);
  FrameLogEvaluation result;
  std::vector<double> latencies_ms;
  std::vector<double> over_sigma2;
  std::vector<double> nees_over_6;
  int num_silent_failures = 0;
  bool has_corner_errors = false;
  // Aligned, poses are no longer in the frame that covariances are of.
  result.judges_covariances = !evaluation.T_truth_estimate;
  for (const FrameLogRow& row : log) {
    ++result.statuses[row.status];
    if (row.latency_ms) latencies_ms.push_back(*row.latency_ms);
    const auto found = frames.find(row.timestamp.ns);
    if (found == frames.end() || !claims_evidence(row)) continue;
    if (!found->second->error) {
      ++result.claimed_without_pose;
      continue;
    }
    const FrameScore& frame = *found->second;
    ++result.claimed_good;
    has_corner_errors = has_corner_errors || frame.corner_error_px;
    if (frame.corner_error_px.value_or(0.0) > kSilentFailure_px) ++num_silent_failures;
    if (!result.judges_covariances) continue;
    const double sigma_m = row.sigma_position_m.value_or(0.0);
    if (sigma_m > 0.0) over_sigma2.push_back(std::pow(frame.error->position_m / sigma_m, 2));
    if (row.covariance) nees_over_6.push_back(normalised_error(row, *frame.error));
  }
  result.claimed_share_of_frames =
      static_cast<double>(result.claimed_good) / static_cast<double>(frames.size());
  if (has_corner_errors) result.claimed_good_but_over_10px = num_silent_failures;
  if (!latencies_ms.empty()) {
    result.latency_p50_ms = percentile(latencies_ms, 0.50);
    result.latency_p99_ms = percentile(latencies_ms, 0.99);
  }
  if (!over_sigma2.empty()) result.mean_squared_position_error_over_sigma2 = mean(over_sigma2);
  if (!nees_over_6.empty()) {
    result.nees_over_6_mean = mean(nees_over_6);
    result.nees_over_6_median = median(nees_over_6);
  }
  return result;
}

}  // namespace apriltrack
