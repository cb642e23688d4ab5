#include "solve/group_motion.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "apriltrack/base/degrees.h"
#include "apriltrack/geometry/rotation.h"
#include "numerics/cauchy_loss.h"

namespace apriltrack {
namespace {

constexpr CauchyLoss kMotionLoss{8.0};  // of a view's whitened norm; a good one's is sqrt(8)
constexpr double kFailedProjection = 1e4;
constexpr int kMaxGroupSteps = 40, kFirstSteps = 4;
constexpr double kLeastDecrease = 1e-6;
constexpr double kPatience = 12.0;  // steps like the last one
constexpr double kMostDamping = 1e8;
constexpr double kSameMinimum_rad = 1.0 * kRadPerDeg, kSameCost = 1.0;

/// One frame's equations and their coupling with the group's motion.
struct FrameBlock {
  bool is_seen = false;  ///< By a view that could be projected.
  Matrix6d H = Matrix6d::Zero(), motion_frame = Matrix6d::Zero();
  Vector6d g = Vector6d::Zero();
};

struct Equations {
  std::vector<FrameBlock> frames;
  Matrix6d H = Matrix6d::Zero();
  Vector6d g = Vector6d::Zero();
};

/// GroupMotion, with the frames in their order.
struct Motion {
  Pose motion;
  std::vector<Pose> T_map_rig;
  double cost = 0.0;
};

bool is_at_one_of(const std::vector<GroupMotion>& minima, const Motion& at) {
  return std::ranges::any_of(minima, [&](const GroupMotion& minimum) {
    return std::abs(at.cost - minimum.cost) < kSameCost &&
           rotation_angle_rad(at.motion.rotation(), minimum.motion.rotation()) < kSameMinimum_rad;
  });
}

Matrix6d damped(const Matrix6d& H, double damping) {
  Matrix6d result = H;
  result.diagonal() += damping * H.diagonal() + Vector6d::Constant(1e-9 * H.diagonal().maxCoeff() + 1e-30);
  return result;
}

class GroupFit {
 public:
  GroupFit(const Observations& observations, const std::vector<std::size_t>& views,
           const std::vector<int>& group, const MapState& state)
      : observations_(observations), state_(state) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const int tag : group) sum += state.T_map_tag[static_cast<std::size_t>(tag)].translation();
    // Turns about the group's middle leave it where it is: a well conditioned motion.
    T_map_middle_ = Pose(Eigen::Quaterniond::Identity(), sum / static_cast<double>(group.size()));
    for (const std::size_t v : views) frames_.push_back(observations.views[v].frame);
    std::ranges::sort(frames_);
    frames_.erase(std::unique(frames_.begin(), frames_.end()), frames_.end());
    for (const std::size_t v : views) {
      const TagView& view = observations.views[v];
      const Pose& T_map_tag = state.T_map_tag[static_cast<std::size_t>(view.tag)];
      const auto frame = std::ranges::lower_bound(frames_, view.frame) - frames_.begin();
      views_.push_back({&view, static_cast<std::size_t>(frame), whitening(view, state),
                        std::ranges::binary_search(group, view.tag),
                        (T_map_tag.inverse() * T_map_middle_).adjoint()});
    }
  }

  GroupMotion run(const GroupMotion& start, const EnoughOfMotion& enough) const {
    Motion best = from(start);
    descend(best, enough);
    GroupMotion result{best.motion, {}, best.cost};
    for (std::size_t i = 0; i < frames_.size(); ++i)
      result.T_map_rig.emplace_hint(result.T_map_rig.end(), frames_[i], best.T_map_rig[i]);
    return result;
  }

  double cost_at(const GroupMotion& start) const { return cost(from(start)); }

 private:
  struct View {
    const TagView* of;
    std::size_t frame;  ///< Into frames_.
    Matrix8d whitening;
    bool moves;
    Eigen::Matrix<double, 6, 6> tag_by_motion;  ///< About the group's middle.
  };

  Motion from(const GroupMotion& start) const {
    Motion motion{start.motion, {}, 0.0};
    for (const int frame : frames_) {
      const auto given = start.T_map_rig.find(frame);
      motion.T_map_rig.push_back(
          given != start.T_map_rig.end() ? given->second : state_.T_map_rig[static_cast<std::size_t>(frame)]);
    }
    return motion;
  }

  void descend(Motion& best, const EnoughOfMotion& enough) const {
    best.cost = cost(best);
    double damping = 1e-4;
    for (int step = 0; step < kMaxGroupSteps && damping < kMostDamping; ++step) {
      const Equations equations = linearise(best);
      std::optional<Motion> next;
      for (; damping < kMostDamping && !next; damping *= next ? 1.0 : 10.0) {
        Motion trial = stepped(best, equations, damping);
        trial.cost = cost(trial);
        if (trial.cost < best.cost) next = std::move(trial);
      }
      if (!next) return;
      const double decrease = best.cost - next->cost;
      best = std::move(*next);
      damping = std::max(1e-9, 0.1 * damping);
      if (decrease < kLeastDecrease * best.cost) return;
      if (step >= kFirstSteps && best.cost - kPatience * decrease > enough.wanted_cost) return;
      if (decrease < kSameCost && is_at_one_of(enough.minima, best)) return;
    }
  }

  bool residual(const View& view, const Motion& at, Vector8d* whitened, Matrix8x6d* by_rig,
                Matrix8x6d* by_tag) const {
    const auto tag = static_cast<std::size_t>(view.of->tag);
    const Pose& T_map_tag = state_.T_map_tag[tag];
    Vector8d residual_px;
    if (!view_residual(state_.cameras[static_cast<std::size_t>(view.of->camera)], observations_.sizes_m[tag],
                       *view.of, at.T_map_rig[view.frame], view.moves ? at.motion * T_map_tag : T_map_tag,
                       &residual_px, by_rig, by_tag))
      return false;
    *whitened = view.whitening.lazyProduct(residual_px);
    if (by_rig != nullptr) *by_rig = view.whitening.lazyProduct(*by_rig).eval();
    if (by_tag != nullptr) *by_tag = view.whitening.lazyProduct(*by_tag).eval();
    return true;
  }

  double cost(const Motion& at) const {
    double sum = 0.0;
    for (const View& view : views_) {
      Vector8d whitened;
      const double squares =
          residual(view, at, &whitened, nullptr, nullptr) ? whitened.squaredNorm() : kFailedProjection;
      sum += kMotionLoss.cost(squares);
    }
    return sum;
  }

  Equations linearise(const Motion& at) const {
    Equations equations;
    equations.frames.resize(frames_.size());
    for (const View& view : views_) {
      Vector8d whitened;
      Matrix8x6d by_rig, by_tag;
      if (!residual(view, at, &whitened, &by_rig, view.moves ? &by_tag : nullptr)) continue;
      const double weight = kMotionLoss.weight(whitened.squaredNorm());
      FrameBlock& frame = equations.frames[view.frame];
      frame.is_seen = true;
      const Matrix8x6d weighted = weight * by_rig;
      frame.H += weighted.transpose().lazyProduct(by_rig);
      frame.g += weighted.transpose().lazyProduct(whitened);
      if (!view.moves) continue;
      const Matrix8x6d by_motion = weight * by_tag.lazyProduct(view.tag_by_motion);
      frame.motion_frame += by_motion.transpose().lazyProduct(by_rig);
      equations.H += by_motion.transpose().lazyProduct(by_motion) / weight;
      equations.g += by_motion.transpose().lazyProduct(whitened);
    }
    return equations;
  }

  /// Of the motion about the middle, and of each frame.
  Motion stepped(const Motion& at, const Equations& equations, double damping) const {
    Matrix6d H = damped(equations.H, damping);
    Vector6d g = equations.g;
    std::vector<Eigen::LDLT<Matrix6d>> factors(frames_.size());
    for (std::size_t i = 0; i < frames_.size(); ++i) {
      const FrameBlock& frame = equations.frames[i];
      if (!frame.is_seen) continue;
      const auto& factor = factors[i].compute(damped(frame.H, damping));
      H -= frame.motion_frame.lazyProduct(factor.solve(frame.motion_frame.transpose()).eval());
      g -= frame.motion_frame * factor.solve(frame.g);
    }
    const Vector6d step = -H.ldlt().solve(g);
    Motion result = at;
    if (!step.allFinite()) return result;
    result.motion = at.motion * T_map_middle_ * Pose::exp(step) * T_map_middle_.inverse();
    for (std::size_t i = 0; i < frames_.size(); ++i) {
      const FrameBlock& frame = equations.frames[i];
      if (!frame.is_seen) continue;
      const Vector6d of_frame = -factors[i].solve(frame.g + frame.motion_frame.transpose() * step);
      if (of_frame.allFinite()) result.T_map_rig[i] = at.T_map_rig[i] * Pose::exp(of_frame);
    }
    return result;
  }

  const Observations& observations_;
  const MapState& state_;
  std::vector<View> views_;
  std::vector<int> frames_;  ///< Of the views, rising.
  Pose T_map_middle_;
};

}  // namespace

GroupMotion fit_group_motion(const Observations& observations, const std::vector<std::size_t>& views,
                             const std::vector<int>& group, const MapState& state, const GroupMotion& start,
                             const EnoughOfMotion& enough) {
  return GroupFit(observations, views, group, state).run(start, enough);
}

double cost_of_group(const Observations& observations, const std::vector<std::size_t>& views,
                     const std::vector<int>& group, const MapState& state) {
  return GroupFit(observations, views, group, state).cost_at({});
}

}  // namespace apriltrack
