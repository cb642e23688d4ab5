#pragma once

#include <vector>

#include "apriltrack/camera/camera_model.h"
#include "apriltrack/geometry/pose.h"
#include "tag_observation.h"

namespace apriltrack {

/// One explanation of a frame: a pose, and the tags that agree with it.
struct PoseCandidate {
  Pose T_camera_map;
  std::vector<const TagObservation*> inliers;  ///< At most one copy of each tag.
  double squared_error = 0.0;                  ///< Of the inliers' corners, whitened.

  int num_corners() const { return kNumCorners * static_cast<int>(inliers.size()); }
};

struct CandidateOptions {
  /// Root mean square of a tag's corners, per axis: one that fits worse agrees with no pose, unless so much
  /// is expected of its corners.
  double max_residual_rms_px = 4.0;
};

/// All distinct minima worth comparing, in no order: started from both planar poses of every tag and from
/// `predictions` (T_camera_map), scored robustly on all corners, the best refined, tags that disagree
/// dropped.
std::vector<PoseCandidate> find_pose_candidates(const CameraModel& model,
                                                const std::vector<TagObservation>& observations,
                                                const std::vector<Pose>& predictions,
                                                const CandidateOptions& options);

/// Whether two poses are one minimum, settled on other tags: their difference is below three sigma in every
/// direction, all of it together, by the winner's covariance (that of the right perturbation, positive
/// definite), the errors of the map's tags included: a tag more moves the pose by as much as that tag is
/// off. The minima of a planar ambiguity are tens of sigma apart, or they could not be told apart from one.
bool is_same_explanation(const Pose& winner, const Matrix6d& cov_winner, const Pose& other);

/// -log likelihood of ALL observations under the pose, with noise_scale times the noise of their covariances;
/// what no pose explains counts as much as a tag three sigma off, wherever it lies. Copies of one tag count
/// once, by the best.
double misfit(const CameraModel& model, const std::vector<TagObservation>& observations, double noise_scale,
              const Pose& T_camera_map);

}  // namespace apriltrack
