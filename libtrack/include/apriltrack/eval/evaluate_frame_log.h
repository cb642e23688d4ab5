#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "apriltrack/eval/evaluate_trajectory.h"
#include "apriltrack/eval/frame_log.h"

namespace apriltrack {

/// A pose that is claimed good and farther off than this is a silent failure.
inline constexpr double kSilentFailure_px = 10.0;

/// What a tracker says of itself against what is true. "Claimed good": status detected or tracked, in a frame
/// that counts and has a pose in the estimate.
struct FrameLogEvaluation {
  std::map<std::string, int> statuses;  ///< Over all rows.
  std::optional<double> latency_p50_ms;
  std::optional<double> latency_p99_ms;
  int claimed_good = 0;
  double claimed_share_of_frames = 0.0;
  int claimed_without_pose = 0;  ///< Claimed, but the estimate has none: the log is of another run.
  std::optional<int> claimed_good_but_over_10px;  ///< Silent failures; nullopt without corner errors.
  /// Not of an aligned estimate: its covariances are of poses in the map's frame, which the map's held tag
  /// defines, and an alignment leaves that frame by as much as the map is wrong. Then there is nothing below.
  bool judges_covariances = true;
  /// Mean over claimed frames; 1 for an honest sigma_position_m.
  std::optional<double> mean_squared_position_error_over_sigma2;
  /// Normalised error squared, xi^T C^-1 xi / 6, over claimed frames; mean 1 for an honest covariance.
  std::optional<double> nees_over_6_mean;
  std::optional<double> nees_over_6_median;
};

/// Rows belong to frames by their exact time. Throws Error(kNoResult) when no row has the time of a frame of
/// `evaluation` (a log of another recording), Error(kInvalidInput) when a covariance has no inverse.
FrameLogEvaluation evaluate_frame_log(const TrajectoryEvaluation& evaluation,
                                      const std::vector<FrameLogRow>& log);

}  // namespace apriltrack
