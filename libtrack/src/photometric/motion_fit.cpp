#include "apriltrack/photometric/motion_fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "active_tags.h"
#include "apriltrack/base/geman_mcclure.h"
#include "apriltrack/camera/pixel_jacobian.h"

namespace apriltrack {
namespace {

/// Neighbouring pixels err together (demosaicing, compression, the model): so many count as one.
constexpr double kCorrelatedPixels = 4.0;
/// Of detected corners, in standard deviations: a false detection must not hold the fit.
constexpr GemanMcClure kCornerError(3.0);

/// How much of the information of independent pixels these carry.
double information_share(const TagPixels& pixels) {
  return std::min(1.0, pixels.stride * pixels.stride / kCorrelatedPixels);
}

TagPrediction prediction_of(PhotometricWorld& world, int index, const MotionState& state,
                            const PhotometricFrame& frame, int level) {
  return {world, world.tags[static_cast<std::size_t>(index)], state, frame.exposure_s, level};
}

struct NormalEquations {
  Matrix12d H = Matrix12d::Zero();
  Vector12d g = Vector12d::Zero();
};

/// A state with what it makes of the tags.
struct Evaluated {
  struct Tag {
    TagPrediction prediction;
    TagColours colours;
  };
  MotionState state;
  double cost = 0.0;
  std::vector<Tag> tags;  ///< As the active ones; none where the cost is infinite.
};

/// The fit of one frame: its data, and what the steps have in common.
class Fit {
 public:
  Fit(PhotometricWorld& world, const PhotometricFrame& frame, const std::optional<MotionBelief>& prior,
      const std::vector<CornerObservation>& corners)
      : world_(world), frame_(frame), prior_(prior), corners_(corners) {
    if (prior_) prior_information_ = prior_->covariance.ldlt().solve(Matrix12d::Identity());
  }

  MotionState refine_on_level(MotionState state, int level, int max_steps, int max_pixels) {
    for (int round = 0; round < 2; ++round) {
      std::vector<ActiveTag> active = active_tags(world_, frame_, state, level, max_pixels);
      // Too coarse for what is seen: the prior alone would pull the state off.
      if (active.empty()) return state;
      set_scales(active);
      state = descend(active, state, level, max_steps / 2);
    }
    return state;
  }

  /// Of the tags given: what explains nothing knows nothing of the state.
  Matrix12d information(const MotionState& state, int level, int max_pixels,
                        const std::vector<TagEvidence>& tags) {
    std::vector<ActiveTag> active = active_tags(world_, frame_, state, level, max_pixels);
    std::erase_if(active, [&](const ActiveTag& one) {
      return std::ranges::none_of(tags, [&](const TagEvidence& tag) { return tag.tag_index == one.index; });
    });
    set_scales(active);
    return equations(active, evaluate(active, state, level)).H;
  }

 private:
  static void set_scales(std::vector<ActiveTag>& active) {
    for (ActiveTag& tag : active) tag.scale = scale_of(measure_misfit(tag.pixels, tag.predicted, 0.0));
  }
  MotionState descend(const std::vector<ActiveTag>& active, const MotionState& start, int level,
                      int max_steps) {
    Evaluated current = evaluate(active, start, level);
    double damping = 1e-3;
    for (int step = 0; step < max_steps; ++step) {
      const NormalEquations normal = equations(active, current);
      bool is_better = false;
      Vector12d move = Vector12d::Zero();
      for (int attempt = 0; attempt < 4 && !is_better; ++attempt) {
        Matrix12d damped = normal.H;
        damped.diagonal() *= 1.0 + damping;
        damped.diagonal().array() += 1e-9;
        move = -damped.ldlt().solve(normal.g);
        if (!move.allFinite()) return current.state;
        Evaluated next = evaluate(active, moved(current.state, move), level);
        is_better = next.cost < current.cost;
        damping = is_better ? std::max(1e-6, 0.2 * damping) : std::max(1e-3, 10.0 * damping);
        if (is_better) current = std::move(next);
      }
      if (!is_better || is_negligible(move)) break;
    }
    return current.state;
  }

  static bool is_negligible(const Vector12d& move) {
    return move.segment<3>(0).norm() < 1e-5 && move.segment<3>(3).norm() < 1e-5;
  }

  Evaluated evaluate(const std::vector<ActiveTag>& active, const MotionState& state, int level) {
    Evaluated result{state, 0.0, {}};
    result.tags.reserve(active.size());
    for (const ActiveTag& tag : active) {
      const TagPrediction prediction = prediction_of(world_, tag.index, state, frame_, level);
      // A tag must not turn its back to be rid of its pixels.
      if (!prediction.is_visible()) return {state, std::numeric_limits<double>::infinity(), {}};
      const TagMisfit misfit = measure_misfit(tag.pixels, predict(prediction, tag.pixels), tag.scale);
      if (misfit.colours.gain <= 0.0) result.cost += static_cast<double>(tag.pixels.count);
      result.cost += information_share(tag.pixels) * misfit.cost;
      result.tags.push_back({prediction, misfit.colours});
    }
    result.cost += prior_cost(state) + corner_cost(state);
    return result;
  }

  double prior_cost(const MotionState& state) const {
    if (!prior_) return 0.0;
    const Vector12d d = difference(prior_->mean, state);
    return 0.5 * d.dot(prior_information_ * d);
  }

  double corner_cost(const MotionState& state) const {
    double sum = 0.0;
    const Pose view = camera_from_map(state.pose, world_.mode);
    for (const CornerObservation& corner : corners_) {
      const auto pixel = world_.model.project(view * corner.point_map);
      const double r2 =
          pixel ? (*pixel - corner.pixel).squaredNorm() / (corner.sigma_px * corner.sigma_px) : 1e6;
      sum += 0.5 * kCornerError.penalty(r2);
    }
    return sum;
  }

  NormalEquations equations(const std::vector<ActiveTag>& active, const Evaluated& at) const {
    NormalEquations left;
    for (std::size_t i = 0; i < at.tags.size(); ++i) {
      const auto& [prediction, colours] = at.tags[i];
      if (colours.gain <= 0.0) continue;
      const ActiveTag& tag = active[i];
      const TagNormalEquations one = linearise(tag.pixels, prediction, colours, tag.scale);
      left.H += information_share(tag.pixels) * one.H;
      left.g += information_share(tag.pixels) * one.g;
    }
    add_corners(at.state, left);
    Matrix12d A = Matrix12d::Zero();
    A.block<6, 6>(0, 0) = A.block<6, 6>(6, 6) = view_by_pose(at.state.pose, world_.mode);
    NormalEquations right{A.transpose() * left.H * A, A.transpose() * left.g};
    if (prior_) {
      right.H += prior_information_;
      right.g += prior_information_ * difference(prior_->mean, at.state);
    }
    return right;
  }

  void add_corners(const MotionState& state, NormalEquations& left) const {
    const Pose view = camera_from_map(state.pose, world_.mode);
    for (const CornerObservation& corner : corners_) {
      Eigen::Matrix<double, 2, 3> by_point;
      const Eigen::Vector3d point = view * corner.point_map;
      const auto pixel = world_.model.project(point, &by_point);
      if (!pixel) continue;
      const Eigen::Matrix<double, 2, 6> J = pixel_jacobian(by_point, point) / corner.sigma_px;
      const Eigen::Vector2d r = (*pixel - corner.pixel) / corner.sigma_px;
      const double w = kCornerError.weight(r.squaredNorm());
      left.H.block<6, 6>(0, 0) += w * J.transpose() * J;
      left.g.head<6>() += w * J.transpose() * r;
    }
  }

  PhotometricWorld& world_;
  const PhotometricFrame& frame_;
  const std::optional<MotionBelief>& prior_;
  const std::vector<CornerObservation>& corners_;
  Matrix12d prior_information_ = Matrix12d::Zero();
};

}  // namespace

MotionFit fit_motion(PhotometricWorld& world, const PhotometricFrame& frame, const MotionState& start,
                     const std::optional<MotionBelief>& prior, const std::vector<CornerObservation>& corners,
                     const MotionFitOptions& options) {
  Fit fit(world, frame, prior, corners);
  MotionFit result;
  result.state = start;
  for (int level = options.coarsest_level; level >= 0; --level)
    result.state =
        fit.refine_on_level(result.state, level, options.max_steps_per_level, options.max_pixels_per_tag);
  result.tags =
      weigh_evidence(world, frame, result.state, {.max_pixels_per_tag = options.max_pixels_per_tag});
  result.information =
      fit.information(result.state, 0, options.max_pixels_per_tag, explained_tags(result.tags));
  return result;
}

}  // namespace apriltrack
