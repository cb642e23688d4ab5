#include "pose_report.h"

#include <Eigen/Cholesky>
#include <cmath>

#include "blur_covariance.h"

namespace apriltrack {
namespace {

constexpr double kLeastOdds = 1e-3;  // what is less likely than this is ruled out

void report_second(const SecondPose& second, TrackResult& result) {
  if (std::exp(second.log_odds) < kLeastOdds) return;
  result.second_pose = second.pose;
  result.second_mode_odds = std::exp(second.log_odds);
}

/// Of the pose: what the fit alone leaves open, without what all frames err by.
Matrix6d noise_covariance(const MotionFit& fit) {
  return Matrix12d(fit.information.ldlt().solve(Matrix12d::Identity())).topLeftCorner<6, 6>();
}

}  // namespace

TrackResult PoseReport::found(const std::vector<Explanation>& found, const MotionBelief& belief) {
  TrackResult result;
  const Explanation& best = found.front();
  result.status = best.votes.agreeing.empty() ? TrackStatus::kTracked : TrackStatus::kDetected;
  result.pose = belief.mean.pose;
  result.velocity = belief.mean.velocity;
  lasting_covariance_ = map_covariance(world_, best.fit) + cover_covariance(world_, best.fit);
  found_pose_ = belief.mean.pose;
  result.covariance = belief.covariance.topLeftCorner<6, 6>() + lasting_covariance_;
  if (const auto mean = at_rest_.add(best.fit.state.pose, noise_covariance(best.fit))) result.pose = *mean;
  if (const auto second = second_pose(belief, found)) report_second(*second, result);
  return result;
}

TrackResult PoseReport::expected(const std::vector<MotionHypothesis>& expected) {
  at_rest_.forget();
  TrackResult result;
  if (expected.empty()) return result;
  const MotionBelief& belief = expected.front().belief;
  result.status = TrackStatus::kPredicted;
  result.pose = belief.mean.pose;
  result.velocity = belief.mean.velocity;
  result.covariance = belief.covariance.topLeftCorner<6, 6>() + lasting_covariance_at(belief.mean.pose);
  if (expected.size() > 1 && is_another(belief, expected[1].belief.mean.pose))
    report_second({expected[1].belief.mean.pose, expected[1].log_odds}, result);
  return result;
}

/// A wrong map is wrong in the same way at the next pose: of the camera in the map's frame, of a body in
/// its own. So is, about, what a covered tag was taken for.
Matrix6d PoseReport::lasting_covariance_at(const Pose& pose) const {
  if (world_.mode == TrackMode::kJoint) return lasting_covariance_;
  const Matrix6d adjoint = (pose.inverse() * found_pose_).adjoint();
  return adjoint * lasting_covariance_ * adjoint.transpose();
}

}  // namespace apriltrack
