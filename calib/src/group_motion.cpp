#include "group_motion.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <optional>

namespace apriltrack {
namespace {

constexpr double kLossScale = 8.0;  // of a view's whitened norm; a good one's is sqrt(8)
constexpr double kFailedProjection = 1e4;
constexpr int kMaxSteps = 40;
constexpr double kLeastDecrease = 1e-6;
constexpr double kMostDamping = 1e8;

/// One frame's equations and their coupling with the group's motion.
struct FrameBlock {
  Matrix6d H = Matrix6d::Zero(), motion_frame = Matrix6d::Zero();
  Vector6d g = Vector6d::Zero();
};

struct Equations {
  std::map<int, FrameBlock> frames;
  Matrix6d H = Matrix6d::Zero();
  Vector6d g = Vector6d::Zero();
};

Matrix6d damped(const Matrix6d& H, double damping) {
  Matrix6d result = H;
  result.diagonal() += damping * H.diagonal() + Vector6d::Constant(1e-9 * H.diagonal().maxCoeff() + 1e-30);
  return result;
}

class GroupFit {
 public:
  GroupFit(const Observations& observations, const std::vector<std::size_t>& views,
           const std::vector<int>& group, const MapState& state)
      : observations_(observations), views_(views), group_(group), state_(state) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const int tag : group) sum += state.T_map_tag[static_cast<std::size_t>(tag)].translation();
    // Turns about the group's middle leave it where it is: a well conditioned motion.
    T_map_middle_ = Pose(Eigen::Quaterniond::Identity(), sum / static_cast<double>(group.size()));
  }

  GroupMotion run(GroupMotion start) const {
    GroupMotion best = std::move(start);
    for (const std::size_t v : views_) {
      const int frame = observations_.views[v].frame;
      best.T_map_rig.try_emplace(frame, state_.T_map_rig[static_cast<std::size_t>(frame)]);
    }
    best.cost = cost(best);
    double damping = 1e-4;
    for (int step = 0; step < kMaxSteps && damping < kMostDamping; ++step) {
      const Equations equations = linearise(best);
      std::optional<GroupMotion> next;
      for (; damping < kMostDamping && !next; damping *= next ? 1.0 : 10.0) {
        GroupMotion trial = stepped(best, equations, damping);
        trial.cost = cost(trial);
        if (trial.cost < best.cost) next = std::move(trial);
      }
      if (!next) break;
      const double decrease = best.cost - next->cost;
      best = std::move(*next);
      damping = std::max(1e-9, 0.1 * damping);
      if (decrease < kLeastDecrease * best.cost) break;
    }
    return best;
  }

 private:
  bool moves(const TagView& view) const { return std::ranges::binary_search(group_, view.tag); }
  Pose tag_pose(const TagView& view, const GroupMotion& at) const {
    const Pose& pose = state_.T_map_tag[static_cast<std::size_t>(view.tag)];
    return moves(view) ? at.motion * pose : pose;
  }
  bool residual(const TagView& view, const GroupMotion& at, Vector8d* whitened, Matrix8x6d* by_rig,
                Matrix8x6d* by_tag) const {
    Vector8d residual_px;
    if (!view_residual(state_.cameras[static_cast<std::size_t>(view.camera)],
                       observations_.sizes_m[static_cast<std::size_t>(view.tag)], view,
                       at.T_map_rig.at(view.frame), tag_pose(view, at), &residual_px, by_rig, by_tag))
      return false;
    const Matrix8d W = whitening(view, state_);
    *whitened = W * residual_px;
    if (by_rig != nullptr) *by_rig = W * *by_rig;
    if (by_tag != nullptr) *by_tag = W * *by_tag;
    return true;
  }

  double cost(const GroupMotion& at) const {
    double sum = 0.0;
    for (const std::size_t v : views_) {
      Vector8d whitened;
      const bool is_valid = residual(observations_.views[v], at, &whitened, nullptr, nullptr);
      const double squares = is_valid ? whitened.squaredNorm() : kFailedProjection;
      sum += 0.5 * kLossScale * kLossScale * std::log1p(squares / (kLossScale * kLossScale));
    }
    return sum;
  }

  Equations linearise(const GroupMotion& at) const {
    Equations equations;
    for (const std::size_t v : views_) {
      const TagView& view = observations_.views[v];
      Vector8d whitened;
      Matrix8x6d by_rig, by_tag;
      if (!residual(view, at, &whitened, &by_rig, &by_tag)) continue;
      const double weight = 1.0 / (1.0 + whitened.squaredNorm() / (kLossScale * kLossScale));
      FrameBlock& frame = equations.frames[view.frame];
      frame.H += weight * by_rig.transpose() * by_rig;
      frame.g += weight * by_rig.transpose() * whitened;
      if (!moves(view)) continue;
      const Pose T_middle_tag =
          T_map_middle_.inverse() * state_.T_map_tag[static_cast<std::size_t>(view.tag)];
      const Matrix8x6d by_motion = by_tag * T_middle_tag.inverse().adjoint();
      frame.motion_frame += weight * by_motion.transpose() * by_rig;
      equations.H += weight * by_motion.transpose() * by_motion;
      equations.g += weight * by_motion.transpose() * whitened;
    }
    return equations;
  }

  /// Of the motion about the middle, and of each frame.
  GroupMotion stepped(const GroupMotion& at, const Equations& equations, double damping) const {
    Matrix6d H = damped(equations.H, damping);
    Vector6d g = equations.g;
    std::map<int, Eigen::LDLT<Matrix6d>> factors;
    for (const auto& [index, frame] : equations.frames) {
      const auto& factor = factors[index].compute(damped(frame.H, damping));
      H -= frame.motion_frame * factor.solve(frame.motion_frame.transpose());
      g -= frame.motion_frame * factor.solve(frame.g);
    }
    const Vector6d step = -H.ldlt().solve(g);
    GroupMotion result = at;
    if (!step.allFinite()) return result;
    result.motion = at.motion * T_map_middle_ * Pose::exp(step) * T_map_middle_.inverse();
    for (const auto& [index, frame] : equations.frames) {
      const Vector6d of_frame = -factors.at(index).solve(frame.g + frame.motion_frame.transpose() * step);
      if (of_frame.allFinite()) result.T_map_rig.at(index) = at.T_map_rig.at(index) * Pose::exp(of_frame);
    }
    return result;
  }

  const Observations& observations_;
  const std::vector<std::size_t>& views_;
  const std::vector<int>& group_;
  const MapState& state_;
  Pose T_map_middle_;
};

}  // namespace

GroupMotion fit_group_motion(const Observations& observations, const std::vector<std::size_t>& views,
                             const std::vector<int>& group, const MapState& state, GroupMotion start) {
  return GroupFit(observations, views, group, state).run(std::move(start));
}

}  // namespace apriltrack
