#include "solve/frame_views.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "model/corner_views.h"
#include "numerics/cauchy_loss.h"

namespace apriltrack {
namespace {

constexpr CauchyLoss kViewLoss{8.0};             // of a view's whitened norm; a good one's is sqrt(8)
constexpr double kFarSquaresOfView = 8.0 * 9.0;  // squares: three sigmas in the mean
constexpr double kUnseen = 400.0;                // cost of a view that cannot be projected
constexpr int kMaxSettleSteps = 6;
constexpr double kSettledCost = 1e-3;  // whether a minimum is another one is told by more
constexpr std::size_t kMaxTriedPoses = 3;

}  // namespace

FrameViews::FrameViews(const PartTask& task, std::vector<std::size_t> views, MapState& state)
    : task_(task),
      views_(std::move(views)),
      state_(state),
      pose_(state.T_map_rig[static_cast<std::size_t>(task.observations.views[views_.front()].frame)]) {}

double FrameViews::cost() const {
  double sum = 0.0;
  for (const std::size_t v : views_) {
    const double squares = squares_of(v);
    sum += std::isfinite(squares) ? kViewLoss.cost(squares) : kUnseen;
  }
  return sum;
}

bool FrameViews::has_far_view() const {
  return std::ranges::any_of(views_, [&](std::size_t v) { return squares_of(v) > kFarSquaresOfView; });
}

// A step may lead uphill where views are far from linear.
double FrameViews::settle() {
  std::pair<double, Pose> best{cost(), pose_};
  double of_last = best.first;
  for (int step = 0; step < kMaxSettleSteps; ++step) {
    Matrix6d information = Matrix6d::Zero();
    Vector6d gradient = Vector6d::Zero();
    for (const LinearView& view : corner_views(task_.observations, views_, state_)) {
      const double weight = kViewLoss.weight(view.residual.squaredNorm());
      information += weight * view.by_rig.transpose() * view.by_rig;
      gradient += weight * view.by_rig.transpose() * view.residual;
    }
    const Vector6d change = -information.ldlt().solve(gradient);
    if (!change.allFinite()) break;
    pose_ = pose_ * Pose::exp(change);
    const double of_this = cost();
    if (of_this < best.first) best = {of_this, pose_};
    if (std::abs(of_this - std::exchange(of_last, of_this)) < kSettledCost) break;
  }
  pose_ = best.second;
  return best.first;
}

std::pair<double, Pose> FrameViews::best_of_proposals() {
  const Pose before = pose_;
  std::pair<double, Pose> best{std::numeric_limits<double>::infinity(), before};
  for (const Pose& proposal : best_proposals()) {
    pose_ = proposal;
    if (const double of_this = settle(); of_this < best.first) best = {of_this, pose_};
  }
  pose_ = before;
  return best;
}

/// Of the whitened residual; infinite for a view that cannot be projected.
double FrameViews::squares_of(std::size_t view) const {
  bool is_valid = false;
  const double squares =
      whitened_residual(task_.observations, task_.observations.views[view], state_, is_valid).squaredNorm();
  return is_valid ? squares : std::numeric_limits<double>::infinity();
}

/// Those that explain the views best as they are.
std::vector<Pose> FrameViews::best_proposals() {
  std::vector<std::pair<double, Pose>> all;
  for (const std::size_t v : views_) {
    const Pose& T_map_tag = state_.T_map_tag[static_cast<std::size_t>(task_.observations.views[v].tag)];
    for (const auto& candidate : task_.candidates[v].candidates) {
      pose_ = T_map_tag * candidate.T_rig_tag.inverse();
      all.emplace_back(cost(), pose_);
    }
  }
  std::ranges::stable_sort(all, {}, &std::pair<double, Pose>::first);
  all.resize(std::min(all.size(), kMaxTriedPoses));
  std::vector<Pose> best;
  for (const auto& [of_this, pose] : all) best.push_back(pose);
  return best;
}

}  // namespace apriltrack
