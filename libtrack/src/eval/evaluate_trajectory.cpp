#include "apriltrack/eval/evaluate_trajectory.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "apriltrack/base/error.h"
#include "apriltrack/eval/alignment.h"
#include "apriltrack/eval/statistics.h"
#include "apriltrack/geometry/rotation.h"
#include "score_summary.h"
#include "time_matching.h"

namespace apriltrack {
namespace {

constexpr int kMinPosesToAlign = 3;

void check_scene(const CornerScene& scene) {
  if (scene.camera.width <= 0 || scene.camera.height <= 0)
    throw invalid_input("camera " + scene.camera.name,
                        "resolution is missing; it tells which tags are in the image");
  check_tag_map(scene.map);
}

/// Positions by a straight line and orientations by the shortest turn, not along one twist: the definition by
/// which recordings are binned by their blur.
Pose interpolate_apart(const Pose& a, const Pose& b, double fraction) {
  const Eigen::Quaterniond turn =
      rotation_exp(fraction * rotation_log(a.rotation().conjugate() * b.rotation()));
  return {a.rotation() * turn, (1.0 - fraction) * a.translation() + fraction * b.translation()};
}

Pose camera_from_map(const Pose& pose, TrajectoryKind kind) {
  return kind == TrajectoryKind::kJoint ? pose : pose.inverse();
}

/// Of true frame i, by the motion to the frame after it (from the one before, for the last).
double blur_px(const Trajectory& truth, std::size_t i, const CornerScene& scene,
               const std::vector<VisibleTag>& visible, TrajectoryKind kind) {
  const double exposure_s = scene.camera.exposure_s.value_or(0.0);
  if (exposure_s <= 0.0 || truth.size() < 2) return 0.0;
  const TimedPose& other = i + 1 < truth.size() ? truth[i + 1] : truth[i - 1];
  const double interval_s = std::abs(seconds_between(truth[i].timestamp, other.timestamp));
  const Pose end = interpolate_apart(truth[i].pose, other.pose, std::min(exposure_s / 2.0 / interval_s, 1.0));
  return longest_corner_path_px(scene, visible, camera_from_map(truth[i].pose, kind),
                                camera_from_map(end, kind));
}

/// nullopt when the frame does not count.
std::optional<FrameScore> score_frame(const Trajectory& truth, std::size_t i,
                                      const std::optional<Pose>& estimate, const CornerScene* scene,
                                      TrajectoryKind kind) {
  FrameScore score{truth[i].timestamp, 0.0, std::nullopt, std::nullopt};
  const Pose T_camera_map = camera_from_map(truth[i].pose, kind);
  std::vector<VisibleTag> visible;
  if (scene) {
    visible = visible_tags(*scene, T_camera_map);
    if (visible.empty()) return std::nullopt;
    score.blur_px = blur_px(truth, i, *scene, visible, kind);
  }
  if (estimate) {
    score.error = pose_error(truth[i].pose, *estimate);
    if (scene)
      score.corner_error_px =
          mean_corner_error_px(*scene, visible, T_camera_map, camera_from_map(*estimate, kind));
  }
  return score;
}

struct MatchedPoses {
  std::vector<Pose> truth;
  std::vector<Pose> estimate;
};

MatchedPoses matched_poses(const Trajectory& truth, const Matches& matches) {
  MatchedPoses poses;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    if (!matches[i]) continue;
    poses.truth.push_back(truth[i].pose);
    poses.estimate.push_back(matches[i]->pose);
  }
  return poses;
}

std::optional<Pose> align_positions(const MatchedPoses& poses) {
  if (poses.truth.size() < kMinPosesToAlign) return std::nullopt;
  return align_rigidly(poses.truth, poses.estimate, 0.0);
}

Pose alignment_or_throw(const std::optional<Pose>& T_truth_estimate) {
  if (T_truth_estimate) return *T_truth_estimate;
  throw no_result(
      "align",
      "the positions of the common frames (fewer than three, or all on one line) do not settle a rotation; "
      "evaluate without alignment");
}

std::optional<double> position_rmse_after(const std::optional<Pose>& T_truth_estimate,
                                          const MatchedPoses& poses) {
  if (!T_truth_estimate) return std::nullopt;
  std::vector<double> distances_m;
  for (std::size_t i = 0; i < poses.truth.size(); ++i)
    distances_m.push_back(
        (poses.truth[i].translation() - *T_truth_estimate * poses.estimate[i].translation()).norm());
  return root_mean_square(distances_m);
}

std::optional<RelativePoseError> relative_error(const Trajectory& truth, const Matches& matches) {
  std::vector<double> positions_m;
  std::vector<double> rotations_rad;
  for (std::size_t i = 0; i + 1 < truth.size(); ++i) {
    if (!matches[i] || !matches[i + 1]) continue;
    const PoseError error = pose_error(truth[i].pose.inverse() * truth[i + 1].pose,
                                       matches[i]->pose.inverse() * matches[i + 1]->pose);
    positions_m.push_back(error.position_m);
    rotations_rad.push_back(error.rotation_rad);
  }
  if (positions_m.empty()) return std::nullopt;
  return RelativePoseError{static_cast<int>(positions_m.size()), root_mean_square(positions_m),
                           root_mean_square(rotations_rad)};
}

}  // namespace

PoseError pose_error(const Pose& truth, const Pose& estimate) {
  const Pose difference = truth.inverse() * estimate;
  const Eigen::Vector3d rotation_vector = rotation_log(difference.rotation());
  PoseError error;
  error.position_m = difference.translation().norm();
  error.rotation_rad = rotation_vector.norm();
  error.xi_estimate_truth << -(difference.rotation().conjugate() * difference.translation()),
      -rotation_vector;
  return error;
}

TrajectoryEvaluation evaluate_trajectory(const Trajectory& truth, const Trajectory& estimate,
                                         const CornerScene* scene, const EvaluationOptions& options) {
  if (truth.empty()) throw no_result("truth", "has no pose");
  if (scene) check_scene(*scene);
  const Matches matches = match(truth, estimate);
  if (count_matches(matches) == 0) throw no_result("estimate", describe_time_mismatch(truth, estimate));

  const MatchedPoses poses = matched_poses(truth, matches);
  const std::optional<Pose> T_truth_estimate = align_positions(poses);

  TrajectoryEvaluation evaluation;
  evaluation.truth_frames = static_cast<int>(truth.size());
  evaluation.unmatched_estimates = count_unmatched(truth, estimate);
  evaluation.aligned_position_rmse_m = position_rmse_after(T_truth_estimate, poses);
  evaluation.relative = relative_error(truth, matches);
  if (options.align) evaluation.T_truth_estimate = alignment_or_throw(T_truth_estimate);

  const Pose motion = evaluation.T_truth_estimate.value_or(Pose::identity());
  for (std::size_t i = 0; i < truth.size(); ++i) {
    std::optional<Pose> pose;
    if (matches[i]) pose = options.align ? motion * matches[i]->pose : matches[i]->pose;
    if (const auto score = score_frame(truth, i, pose, scene, options.kind))
      evaluation.frames.push_back(*score);
  }
  if (evaluation.frames.empty())
    throw no_result(
        "truth", "shows no tag in any frame; do camera, map and mode (ego or joint) belong to this truth?");

  evaluation.overall = summarise(evaluation.frames, scene != nullptr);
  if (scene) evaluation.by_blur = bin_by_blur(evaluation.frames);
  return evaluation;
}

}  // namespace apriltrack
