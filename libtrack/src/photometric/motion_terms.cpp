#include "motion_terms.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "apriltrack/base/geman_mcclure.h"
#include "apriltrack/camera/pixel_jacobian.h"

namespace apriltrack {
namespace {

/// Of detected corners, in standard deviations: a false detection must not hold the fit.
constexpr GemanMcClure kCornerError(3.0);
/// Squared, of a corner that the state puts where no pixel is.
constexpr double kUnseenCorner2 = 1e6;

}  // namespace

PriorTerm::PriorTerm(const std::optional<MotionBelief>& belief) : belief_(belief) {
  if (belief_) information_ = belief_->covariance.ldlt().solve(Matrix12d::Identity());
}

double PriorTerm::cost(const MotionState& state) const {
  if (!belief_) return 0.0;
  const Vector12d d = difference(belief_->mean, state);
  return 0.5 * d.dot(information_ * d);
}

void PriorTerm::add_to(MotionEquations& by_state, const MotionState& state) const {
  if (belief_) by_state += {information_, information_ * difference(belief_->mean, state)};
}

double CornerTerm::cost(const MotionState& state) const {
  double sum = 0.0;
  const Pose view = camera_from_map(state.pose, world_.mode);
  for (const CornerObservation& corner : corners_) {
    const auto pixel = world_.model.project(view * corner.point_map);
    const double r2 =
        pixel ? (*pixel - corner.pixel).squaredNorm() / (corner.sigma_px * corner.sigma_px) : kUnseenCorner2;
    sum += 0.5 * kCornerError.penalty(r2);
  }
  return sum;
}

void CornerTerm::add_to(MotionEquations& by_view, const MotionState& state) const {
  const Pose view = camera_from_map(state.pose, world_.mode);
  for (const CornerObservation& corner : corners_) {
    Eigen::Matrix<double, 2, 3> by_point;
    const Eigen::Vector3d point = view * corner.point_map;
    const auto pixel = world_.model.project(point, &by_point);
    if (!pixel) continue;
    const Eigen::Matrix<double, 2, 6> J = pixel_jacobian(by_point, point) / corner.sigma_px;
    const Eigen::Vector2d r = (*pixel - corner.pixel) / corner.sigma_px;
    const double w = kCornerError.weight(r.squaredNorm());
    by_view.H.block<6, 6>(0, 0) += w * J.transpose() * J;
    by_view.g.head<6>() += w * J.transpose() * r;
  }
}

}  // namespace apriltrack
