#include "apriltrack/photometric/motion_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "apriltrack/base/geman_mcclure.h"
#include "apriltrack/camera/pixel_jacobian.h"
#include "photometric_scratch.h"

namespace apriltrack {
namespace {

/// Of detected corners, in standard deviations: a false detection must not hold the fit.
constexpr GemanMcClure kCornerError(3.0);

struct NormalEquations {
  Matrix12d H = Matrix12d::Zero();
  Vector12d g = Vector12d::Zero();

  NormalEquations& operator+=(const NormalEquations& other) {
    H += other.H;
    g += other.g;
    return *this;
  }
};

/// A state with what it makes of the active tags.
struct Evaluated {
  struct Tag {
    TagPrediction prediction;
    TagMisfit misfit;
  };
  MotionState state;
  double cost = 0.0;
  std::vector<Tag> tags;  ///< In the order of the active ones; not all where the cost is infinite.
};

/// How far a tag's picture moves between two predictions, pixels of level 0.
double displacement_px(const TagPrediction& from, const TagPrediction& to, double focal_px) {
  double largest_px = 0.0;
  for (const Eigen::Vector3d& point : {Eigen::Vector3d(-1, -1, 1), Eigen::Vector3d(1, 1, 1)}) {
    const Eigen::Vector2d before = (from.camera_from_plane()[1] * point).hnormalized();
    const Eigen::Vector2d after = (to.camera_from_plane()[1] * point).hnormalized();
    largest_px = std::max(largest_px, focal_px * (after - before).norm());
  }
  return largest_px;
}

/// The fit of one frame: its data, and what the steps have in common.
class Fit {
 public:
  Fit(PhotometricWorld& world, const PhotometricFrame& frame, const std::optional<MotionBelief>& prior,
      const std::vector<CornerObservation>& corners, const MotionFitOptions& options)
      : world_(world),
        frame_(frame),
        prior_(prior),
        corners_(corners),
        options_(options),
        active_(world.scratch->active) {
    if (prior_) prior_information_ = prior_->covariance.ldlt().solve(Matrix12d::Identity());
  }

  MotionState refined(MotionState state) {
    for (int level = options_.coarsest_level; level >= options_.finest_level; --level) {
      state = refined_on_level(state, level);
      if (!active_.tags().empty() && widespread_correlation(evidence()) < options_.least_correlation) break;
    }
    return state;
  }

  /// Where the path is better without the acceleration that the options suggest, it is fitted without.
  MotionFit straightened(MotionFit bent) {
    if (bent.state.acceleration.isZero() || options_.acceleration_per_change == 0.0) return bent;
    MotionState straight = bent.state;
    straight.acceleration.setZero();
    evaluate(straight, 0);
    if (next_.cost >= current_.cost) return bent;
    is_straight_ = true;
    return summary(refined_on_level(straight, 0));
  }

  /// With all pixels one step more. What explains nothing knows nothing of the state: information is that of
  /// the tags explained.
  MotionFit summary(const MotionState& state) {
    find(state, {.level = 0, .max_pixels = EvidenceOptions().max_pixels_per_tag, .more_where_sharp = true});
    evaluate_found(state);
    std::vector<NormalEquations> of_tags = equations_of_tags();
    const NormalEquations normal = by_state(sum_of(of_tags));
    const Vector12d step = -normal.H.ldlt().solve(normal.g);
    if (step.allFinite()) {
      evaluate(moved(state, step), 0);
      if (next_.cost < current_.cost) {
        std::swap(current_, next_);
        const bool is_far = -normal.g.dot(step) > kMaxLinearStep2;
        of_tags = is_far ? equations_of_tags() : carried_on(of_tags, view_by_state(state) * step);
      }
    }
    MotionFit result;
    result.state = current_.state;
    result.tags = evidence();
    for (std::size_t i = 0; i < current_.tags.size(); ++i)
      result.equations.push_back({result.tags[i], of_tags[i].H, of_tags[i].g});
    result.information = by_state(sum_of_explained(result.equations)).H;
    return result;
  }

 private:
  MotionState refined_on_level(MotionState state, int level) {
    for (int step = 0; step < options_.max_steps_per_level; step += kStepsPerSelection) {
      if (level == 0) bend(state);
      find(state, {.level = level,
                   .max_pixels = options_.max_pixels_per_tag,
                   .max_pixels_in_all = kTagsInFull * options_.max_pixels_per_tag,
                   .extra_sigma_px = options_.extra_sigma_px});
      // Too coarse for what is seen: the prior alone would pull the state off.
      if (active_.tags().empty()) return state;
      evaluate_found(state);
      const bool has_settled = descend(level);
      state = current_.state;
      if (has_settled && !has_left_its_pixels(level)) break;
    }
    return state;
  }

  void bend(MotionState& state) const {
    if (is_straight_ || options_.acceleration_per_change == 0.0) return;
    state.acceleration = options_.acceleration_per_change * (state.velocity - options_.velocity_before);
  }

  static constexpr int kStepsPerSelection = 4;
  /// While the state moves: more tags than these share the pixels of so many.
  static constexpr int kTagsInFull = 5;
  /// Squared standard deviations that the step ahead would still move the state: nobody sees them.
  static constexpr double kNegligibleStep2 = 0.01;
  static constexpr double kNegligibleStep2Coarse = 0.25;
  /// Likewise: a step that should gain so little, and gains nothing, was the last.
  static constexpr double kDoubtfulStep2 = 0.25;
  /// Likewise: after no more than this the equations are those of before, their gradients carried on. They
  /// cost as much as all steps on the finest level together.
  static constexpr double kMaxLinearStep2 = 25.0;

  void find(const MotionState& state, const ActiveTagsOptions& options) {
    ViewPath path(state, frame_.exposure_s, world_.mode);
    active_.find(world_, frame_, path, options);
    misfits_.clear();
    for (ActiveTag& tag : active_.tags()) {
      tag.scale = scale_of(misfit_of(tag, tag.predicted, 0.0));
      misfits_.push_back(misfit_of(tag, tag.predicted, tag.scale));
    }
  }

  TagMisfit misfit_of(const ActiveTag& tag, const PredictedPixels& predicted, double scale) {
    return measure_misfit(tag.pixels, predicted, scale, &world_.scratch->weights);
  }

  /// The state that the active tags were found for.
  void evaluate_found(const MotionState& state) {
    begin(state, current_);
    for (std::size_t i = 0; i < misfits_.size(); ++i)
      add(active_.tags()[i], *active_.tags()[i].prediction, misfits_[i], current_);
  }

  /// Into next_.
  void evaluate(const MotionState& state, int level) {
    begin(state, next_);
    ViewPath path(state, frame_.exposure_s, world_.mode);
    for (const ActiveTag& tag : active_.tags()) {
      const TagPrediction prediction(world_, world_.tags[static_cast<std::size_t>(tag.index)], path, level,
                                     options_.extra_sigma_px);
      // A tag must not turn its back to be rid of its pixels.
      if (!prediction.is_visible()) {
        next_.cost = std::numeric_limits<double>::infinity();
        return;
      }
      PredictedPixels& predicted = world_.scratch->predicted;
      predict(prediction, tag.pixels, &predicted);
      add(tag, prediction, misfit_of(tag, predicted, tag.scale), next_);
      if (next_.cost >= current_.cost) return;  // costs only grow
    }
  }

  void begin(const MotionState& state, Evaluated& evaluated) const {
    evaluated.state = state;
    evaluated.cost = prior_cost(state) + corner_cost(state);
    evaluated.tags.clear();
  }

  static void add(const ActiveTag& tag, const TagPrediction& prediction, const TagMisfit& misfit,
                  Evaluated& evaluated) {
    if (misfit.colours.gain <= 0.0) evaluated.cost += static_cast<double>(tag.pixels.count);
    evaluated.cost += tag.pixels.information_share() * misfit.cost;
    evaluated.tags.push_back({prediction, misfit});
  }

  /// Levenberg and Marquardt's steps from current_. Whether no step is left to make.
  bool descend(int level) {
    const double negligible2 = level == 0 ? kNegligibleStep2 : kNegligibleStep2Coarse;
    double damping = 1e-3;
    double last_step2 = 0.0;  // of none
    for (int step = 0; step < kStepsPerSelection; ++step) {
      const NormalEquations normal = equations();
      bool is_better = false;
      double step2 = 0.0;
      for (int attempt = 0; attempt < 4 && !is_better; ++attempt) {
        Matrix12d damped = normal.H;
        damped.diagonal() *= 1.0 + damping;
        damped.diagonal().array() += 1e-9;
        const Vector12d move = -damped.ldlt().solve(normal.g);
        if (!move.allFinite()) return true;
        step2 = -normal.g.dot(move);
        if (step2 < negligible2) return true;
        evaluate(moved(current_.state, move), level);
        is_better = next_.cost < current_.cost;
        // What is promised is less than what costs are rounded by: shorter steps promise still less.
        if (!is_better && step2 < kDoubtfulStep2) return true;
        damping = is_better ? std::max(1e-6, 0.2 * damping) : std::max(1e-3, 10.0 * damping);
        if (is_better) std::swap(current_, next_);
      }
      if (!is_better) return true;
      // As steps shrink, the next one is negligible: it need not be known.
      if (step2 * step2 < negligible2 * last_step2) return true;
      last_step2 = step2;
    }
    return false;
  }

  bool has_left_its_pixels(int level) const {
    for (std::size_t i = 0; i < current_.tags.size(); ++i) {
      const double moved_px =
          displacement_px(*active_.tags()[i].prediction, current_.tags[i].prediction, world_.focal_px());
      if (moved_px > kMaxMoved * (1 << level)) return true;
    }
    return false;
  }
  /// Pixels of the level that a tag may move from those that were chosen for it.
  static constexpr double kMaxMoved = 1.0;

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

  /// At current_.
  std::vector<TagEvidence> evidence() const {
    std::vector<TagEvidence> tags;
    for (std::size_t i = 0; i < current_.tags.size(); ++i)
      tags.push_back(evidence_of(active_.tags()[i], current_.tags[i].misfit));
    return tags;
  }

  /// At current_, of everything.
  NormalEquations equations() const {
    NormalEquations of_tags;
    for (std::size_t i = 0; i < current_.tags.size(); ++i) of_tags += equations_of_tag(i);
    return by_state(of_tags);
  }

  std::vector<NormalEquations> equations_of_tags() const {
    std::vector<NormalEquations> of_tags;
    for (std::size_t i = 0; i < current_.tags.size(); ++i) of_tags.push_back(equations_of_tag(i));
    return of_tags;
  }

  static NormalEquations sum_of(const std::vector<NormalEquations>& of_tags) {
    NormalEquations sum;
    for (const NormalEquations& one : of_tags) sum += one;
    return sum;
  }

  /// After a step of the view and its rate.
  static std::vector<NormalEquations> carried_on(std::vector<NormalEquations> of_tags,
                                                 const Vector12d& step) {
    for (NormalEquations& one : of_tags) one.g += one.H * step;
    return of_tags;
  }

  /// By the left perturbation of the view, and by its rate.
  NormalEquations equations_of_tag(std::size_t i) const {
    const auto& [prediction, misfit] = current_.tags[i];
    const ActiveTag& tag = active_.tags()[i];
    if (misfit.colours.gain <= 0.0) return {};
    const TagNormalEquations one = linearise(tag.pixels, prediction, misfit.colours, tag.scale);
    return {tag.pixels.information_share() * one.H, tag.pixels.information_share() * one.g};
  }

  /// As explained_tags() chooses.
  static NormalEquations sum_of_explained(const std::vector<TagEquations>& tags) {
    const bool is_any = std::ranges::any_of(tags, &TagEvidence::is_explained, &TagEquations::evidence);
    NormalEquations sum;
    for (const TagEquations& tag : tags) {
      if (tag.evidence.is_explained() || !is_any) sum += {tag.H, tag.g};
    }
    return sum;
  }

  Matrix12d view_by_state(const MotionState& state) const {
    Matrix12d A = Matrix12d::Zero();
    A.block<6, 6>(0, 0) = A.block<6, 6>(6, 6) = view_by_pose(state.pose, world_.mode);
    return A;
  }

  /// Those of the tags, with the corners, by the state, with the prior.
  NormalEquations by_state(NormalEquations of_tags) const {
    const MotionState& state = current_.state;
    add_corners(state, of_tags);
    const Matrix12d A = view_by_state(state);
    NormalEquations result{A.transpose() * of_tags.H * A, A.transpose() * of_tags.g};
    if (prior_) {
      result.H += prior_information_;
      result.g += prior_information_ * difference(prior_->mean, state);
    }
    return result;
  }

  void add_corners(const MotionState& state, NormalEquations& of_tags) const {
    const Pose view = camera_from_map(state.pose, world_.mode);
    for (const CornerObservation& corner : corners_) {
      Eigen::Matrix<double, 2, 3> by_point;
      const Eigen::Vector3d point = view * corner.point_map;
      const auto pixel = world_.model.project(point, &by_point);
      if (!pixel) continue;
      const Eigen::Matrix<double, 2, 6> J = pixel_jacobian(by_point, point) / corner.sigma_px;
      const Eigen::Vector2d r = (*pixel - corner.pixel) / corner.sigma_px;
      const double w = kCornerError.weight(r.squaredNorm());
      of_tags.H.block<6, 6>(0, 0) += w * J.transpose() * J;
      of_tags.g.head<6>() += w * J.transpose() * r;
    }
  }

  PhotometricWorld& world_;
  const PhotometricFrame& frame_;
  const std::optional<MotionBelief>& prior_;
  const std::vector<CornerObservation>& corners_;
  const MotionFitOptions& options_;
  ActiveTags& active_;
  std::vector<TagMisfit> misfits_;  ///< Of the active tags, where they were found.
  Evaluated current_, next_;
  Matrix12d prior_information_ = Matrix12d::Zero();
  bool is_straight_ = false;  ///< The acceleration was tried, and is not used.
};

}  // namespace

MotionFit fit_motion(PhotometricWorld& world, const PhotometricFrame& frame, const MotionState& start,
                     const std::optional<MotionBelief>& prior, const std::vector<CornerObservation>& corners,
                     const MotionFitOptions& options) {
  Fit fit(world, frame, prior, corners, options);
  return fit.straightened(fit.summary(fit.refined(start)));
}

MotionState descend_motion(PhotometricWorld& world, const PhotometricFrame& frame, const MotionState& start,
                           const std::optional<MotionBelief>& prior, const MotionFitOptions& options) {
  return Fit(world, frame, prior, {}, options).refined(start);
}

}  // namespace apriltrack
