#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "apriltrack/eval/corner_error.h"
#include "apriltrack/eval/trajectory.h"

namespace apriltrack {

/// What the poses of a trajectory are.
enum class TrajectoryKind {
  kEgo,    ///< T_world_camera: a camera moves through a mapped world.
  kJoint,  ///< T_camera_body: a mapped body moves before a camera.
};

struct EvaluationOptions {
  TrajectoryKind kind = TrajectoryKind::kEgo;
  /// Bring the whole estimate onto the truth by one rigid motion first, for an estimate whose world frame is
  /// another. Without it, nothing is aligned: a wrong map shows.
  bool align = false;
};

/// Of D = T_truth^-1 * T_estimate.
struct PoseError {
  double position_m = 0.0;
  double rotation_rad = 0.0;
  /// truth = estimate * exp(xi) to first order, [translation; rotation]: what the estimate's covariance
  /// speaks of.
  Vector6d xi_estimate_truth = Vector6d::Zero();
};

PoseError pose_error(const Pose& truth, const Pose& estimate);

struct FrameScore {
  Timestamp timestamp;  ///< Of the truth.
  /// Longest path of a visible corner during the exposure, from the truth's own motion; 0 without a scene or
  /// exposure.
  double blur_px = 0.0;
  /// nullopt when the estimate has no pose within 1 ms.
  std::optional<PoseError> error;
  std::optional<double> corner_error_px;  ///< Where there are a pose and a scene.
};

/// Coverage and success are shares of all frames; a frame without a pose fails, and is left out of the rest.
/// What cannot be told (no pose at all, no scene) is nullopt.
struct ErrorSummary {
  int frames = 0;
  double coverage = 0.0;
  std::optional<double> success_5px;  ///< Share of the frames with a corner error under 5 px.
  std::optional<double> median_px;
  std::optional<double> p95_px;
  std::optional<double> position_rmse_m;
  std::optional<double> rotation_rmse_rad;
  std::optional<double> position_median_m;
  std::optional<double> rotation_median_rad;
};

/// has_scene: whether corner errors were measured; then success_5px is told even where no frame has a pose.
ErrorSummary summarise(const std::vector<FrameScore>& frames, bool has_scene);

struct BlurBin {
  double from_px = 0.0;
  double to_px = std::numeric_limits<double>::infinity();
  ErrorSummary summary;
};

/// Relative pose error over one frame (Sturm et al., IROS 2012): drift and jitter, whatever the world frame.
struct RelativePoseError {
  int pairs = 0;
  double position_rmse_m = 0.0;
  double rotation_rmse_rad = 0.0;
};

struct TrajectoryEvaluation {
  std::vector<FrameScore>
      frames;  ///< Those that count: with a scene, frames whose truth shows a tag; else all.
  int truth_frames = 0;
  int unmatched_estimates = 0;  ///< Poses of the estimate with no true frame within 1 ms.
  ErrorSummary overall;
  std::vector<BlurBin> by_blur;  ///< Bins with frames; empty without a scene.
  std::optional<RelativePoseError> relative;
  /// Absolute trajectory error: RMS of positions after the best rigid motion; nullopt when positions do not
  /// settle it.
  std::optional<double> aligned_position_rmse_m;
  std::optional<Pose> T_truth_estimate;  ///< The motion that was applied, when asked to align.
};

/// scene: nullptr to score poses only. Throws Error(kInvalidInput) when the scene's camera has no resolution
/// or its map is not as check_tag_map() wants it; Error(kNoResult) when the truth is empty or shows no tag,
/// when no frame is in both (the message tells how the times differ), or when positions do not settle an
/// alignment that was asked for.
TrajectoryEvaluation evaluate_trajectory(const Trajectory& truth, const Trajectory& estimate,
                                         const CornerScene* scene, const EvaluationOptions& options);

}  // namespace apriltrack
