#pragma once

#include <optional>
#include <vector>

#include "apriltrack/tracker/track_result.h"
#include "explanation.h"
#include "motion_memory.h"
#include "resting_pose.h"
#include "rivals.h"

namespace apriltrack {

/// Tells users the poses of one recording: what is found, averaged where nothing moves, and what is expected
/// where nothing is; with all that they may be off by, and the other pose that they may be. world: must
/// outlive it.
class PoseReport {
 public:
  explicit PoseReport(const PhotometricWorld& world) : world_(world) {}

  /// Status and poses as the explanations found have them, best first, at least one. belief: of the best.
  TrackResult found(const std::vector<Explanation>& found, const MotionBelief& belief);
  /// As they are expected, the likeliest first, where the frame says nothing; lost where nothing is.
  TrackResult expected(const std::vector<MotionHypothesis>& expected);

 private:
  Matrix6d lasting_covariance_at(const Pose& pose) const;

  const PhotometricWorld& world_;
  RestingPose at_rest_;
  /// What the map, and what covers its tags, add to the covariance of the pose found last,
  Matrix6d lasting_covariance_ = Matrix6d::Zero();
  Pose found_pose_;  ///< at that pose.
};

}  // namespace apriltrack
