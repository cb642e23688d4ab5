#include "apriltrack/photometric/motion_fit.h"

#include <algorithm>
#include <utility>

#include "motion_descent.h"
#include "motion_objective.h"

namespace apriltrack {
namespace {

/// Before pixels are chosen anew.
constexpr int kStepsPerSelection = 4;
/// While the state moves: more tags than these share the pixels of so many.
constexpr int kTagsInFull = 5;
/// Squared standard deviations: after a step of no more the equations are those of before, their gradients
/// carried on. They cost as much as all steps on the finest level together.
constexpr double kMaxLinear2 = 25.0;

/// Likewise: one of each number. A step of no more, by which no tag moves by more than this, is taken unseen,
/// for it changes little of what the tags show.
constexpr double kMaxUnseen2 = 12.0;
constexpr double kMaxUnseen_px = 0.25;

/// The same path but for its acceleration: the places passed keep their mean, which is what a picture tells.
MotionState bent_by(const Vector6d& acceleration, const MotionState& state, double exposure_s) {
  Vector12d step = Vector12d::Zero();
  step.head<6>() = exposure_s * exposure_s / 24.0 * (state.acceleration - acceleration);
  MotionState result = moved(state, step);
  result.acceleration = acceleration;
  return result;
}

/// As explained_tags() chooses.
MotionEquations sum_of_explained(const std::vector<TagEquations>& tags) {
  const bool is_any = std::ranges::any_of(tags, &TagEvidence::is_explained, &TagEquations::evidence);
  MotionEquations sum;
  for (const TagEquations& tag : tags) {
    if (tag.evidence.is_explained() || !is_any) sum += {tag.H, tag.g};
  }
  return sum;
}

/// The fit of one frame.
class Fit {
 public:
  Fit(const MotionObjective& objective, double exposure_s, const MotionFitOptions& options)
      : objective_(objective), exposure_s_(exposure_s), options_(options) {}

  /// Level by level, coarse to fine, until one explains nothing.
  MotionState refined(MotionState state) {
    for (int level = options_.coarsest_level; level >= options_.finest_level; --level) {
      state = refined_on_level(state, level);
      if (objective_.has_pixels() &&
          widespread_correlation(objective_.evidence(current_)) < options_.least_correlation)
        break;
    }
    return state;
  }

  /// Where the path is better without the acceleration that the options suggest, it is fitted without. Judged
  /// by the pixels that it was fitted to.
  MotionState straightened(const MotionState& bent) {
    if (bent.acceleration.isZero() || options_.acceleration_per_change == 0.0) return bent;
    if (objective_.level() > 0 || !objective_.has_pixels()) return bent;
    const MotionState straight = bent_by(Vector6d::Zero(), bent, exposure_s_);
    objective_.evaluate(straight, current_.cost, next_);
    if (!(next_.cost < current_.cost)) return bent;
    is_straight_ = true;
    return refined_on_level(straight, 0);
  }

  /// With all pixels one step more.
  MotionFit summary(const MotionState& state) {
    objective_.choose_pixels(
        state, {.level = 0, .max_pixels = EvidenceOptions().max_pixels_per_tag, .more_where_sharp = true});
    objective_.evaluate_chosen(current_);
    const std::vector<MotionEquations> of_tags = equations_after_last_step();
    MotionFit result;
    result.state = current_.state;
    result.tags = objective_.evidence(current_);
    for (std::size_t i = 0; i < of_tags.size(); ++i)
      result.equations.push_back({result.tags[i], of_tags[i].H, of_tags[i].g});
    // What explains nothing knows nothing of the state.
    result.information = objective_.by_state(sum_of_explained(result.equations), result.state).H;
    return result;
  }

 private:
  MotionState refined_on_level(MotionState state, int level) {
    for (int step = 0; step < options_.max_steps_per_level; step += kStepsPerSelection) {
      if (level == 0) bend(state);
      objective_.choose_pixels(state, {.level = level,
                                       .max_pixels = options_.max_pixels_per_tag,
                                       .max_pixels_in_all = kTagsInFull * options_.max_pixels_per_tag,
                                       .extra_sigma_px = options_.extra_sigma_px});
      // Too coarse for what is seen: the prior alone would pull the state off.
      if (!objective_.has_pixels()) return state;
      objective_.evaluate_chosen(current_);
      const bool has_settled = descend(objective_, kStepsPerSelection, current_, next_);
      state = current_.state;
      if (has_settled && !objective_.has_left_its_pixels(current_)) break;
    }
    return state;
  }

  void bend(MotionState& state) const {
    if (is_straight_ || options_.acceleration_per_change == 0.0) return;
    const Vector6d change = state.velocity - options_.velocity_before;
    state.acceleration = options_.acceleration_per_change * change;
  }

  /// The tags', where the step leads.
  std::vector<MotionEquations> equations_after_last_step() {
    std::vector<MotionEquations> of_tags = objective_.equations_of_tags(current_);
    MotionEquations sum;
    for (const MotionEquations& one : of_tags) sum += one;
    const MotionEquations all = objective_.by_state(sum, current_.state);
    const Vector12d step = all.step();
    if (!step.allFinite()) return of_tags;
    const Vector12d step_of_view = objective_.view_by_state(current_.state) * step;
    if (!take_last_step(step, all.worth(step))) return of_tags;
    if (all.worth(step) > kMaxLinear2) return objective_.equations_of_tags(current_);
    for (MotionEquations& one : of_tags) one.g += one.H * step_of_view;
    return of_tags;
  }

  /// Whether it was taken: not where it turns out to lead to nothing better.
  bool take_last_step(const Vector12d& step, double worth2) {
    const MotionState next = moved(current_.state, step);
    if (worth2 <= kMaxUnseen2 && objective_.largest_move_px(next) < kMaxUnseen_px) {
      current_.state = next;
      return true;
    }
    objective_.evaluate(next, current_.cost, next_);
    if (!(next_.cost < current_.cost)) return false;
    std::swap(current_, next_);
    return true;
  }

  MotionObjective objective_;
  double exposure_s_;
  const MotionFitOptions& options_;
  EvaluatedState current_, next_;
  bool is_straight_ = false;  ///< The acceleration was tried, and is not used.
};

}  // namespace

MotionFit fit_motion(PhotometricWorld& world, const PhotometricFrame& frame, const MotionState& start,
                     const std::optional<MotionBelief>& prior, const std::vector<CornerObservation>& corners,
                     const MotionFitOptions& options) {
  Fit fit({world, frame, prior, corners}, frame.exposure_s, options);
  return fit.summary(fit.straightened(fit.refined(start)));
}

MotionState descend_motion(PhotometricWorld& world, const PhotometricFrame& frame, const MotionState& start,
                           const std::optional<MotionBelief>& prior, const MotionFitOptions& options) {
  const std::vector<CornerObservation> no_corners;
  return Fit({world, frame, prior, no_corners}, frame.exposure_s, options).refined(start);
}

}  // namespace apriltrack
