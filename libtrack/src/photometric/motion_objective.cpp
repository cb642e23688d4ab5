#include "motion_objective.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "photometric_scratch.h"

namespace apriltrack {
namespace {

/// Pixels of the level that a tag may move from those that were chosen for it.
constexpr double kMaxMoved = 1.0;

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

void add(const ActiveTag& tag, const TagPrediction& prediction, const TagMisfit& misfit,
         EvaluatedState& evaluated) {
  if (misfit.colours.gain <= 0.0) evaluated.cost += static_cast<double>(tag.pixels.count);
  evaluated.cost += tag.pixels.information_share() * misfit.cost;
  evaluated.tags.push_back({prediction, misfit});
}

}  // namespace

MotionObjective::MotionObjective(PhotometricWorld& world, const PhotometricFrame& frame,
                                 const std::optional<MotionBelief>& prior,
                                 const std::vector<CornerObservation>& corners)
    : world_(world), frame_(frame), prior_(prior), corners_(world, corners), active_(world.scratch->active) {}

void MotionObjective::choose_pixels(const MotionState& state, const ActiveTagsOptions& options) {
  options_ = options;
  chosen_for_ = state;
  ViewPath path(state, frame_.exposure_s, world_.mode);
  active_.find(world_, frame_, path, options);
  misfits_.clear();
  for (ActiveTag& tag : active_.tags()) {
    tag.scale = scale_of(misfit_of(tag, tag.predicted, 0.0));
    misfits_.push_back(misfit_of(tag, tag.predicted, tag.scale));
  }
}

bool MotionObjective::has_left_its_pixels(const EvaluatedState& evaluated) const {
  for (std::size_t i = 0; i < evaluated.tags.size(); ++i) {
    const double moved_px =
        displacement_px(*active_.tags()[i].prediction, evaluated.tags[i].prediction, world_.focal_px());
    if (moved_px > kMaxMoved * (1 << level())) return true;
  }
  return false;
}

double MotionObjective::largest_move_px(const MotionState& to) const {
  ViewPath path(to, frame_.exposure_s, world_.mode);
  double largest_px = 0.0;
  for (const ActiveTag& tag : active_.tags()) {
    const TagPrediction there(world_, world_.tags[static_cast<std::size_t>(tag.index)], path, options_.level,
                              options_.extra_sigma_px);
    if (!there.is_visible()) return std::numeric_limits<double>::infinity();
    largest_px = std::max(largest_px, displacement_px(*tag.prediction, there, world_.focal_px()));
  }
  return largest_px;
}

void MotionObjective::evaluate_chosen(EvaluatedState& evaluated) const {
  begin(chosen_for_, evaluated);
  for (std::size_t i = 0; i < misfits_.size(); ++i)
    add(active_.tags()[i], *active_.tags()[i].prediction, misfits_[i], evaluated);
}

void MotionObjective::evaluate(const MotionState& state, double limit, EvaluatedState& evaluated) const {
  begin(state, evaluated);
  ViewPath path(state, frame_.exposure_s, world_.mode);
  for (const ActiveTag& tag : active_.tags()) {
    const TagPrediction prediction(world_, world_.tags[static_cast<std::size_t>(tag.index)], path,
                                   options_.level, options_.extra_sigma_px);
    // A tag must not turn its back to be rid of its pixels.
    if (!prediction.is_visible()) {
      evaluated.cost = std::numeric_limits<double>::infinity();
      return;
    }
    PredictedPixels& predicted = world_.scratch->predicted;
    predict(prediction, tag.pixels, &predicted);
    add(tag, prediction, misfit_of(tag, predicted, tag.scale), evaluated);
    if (evaluated.cost >= limit) return;  // costs only grow
  }
}

MotionEquations MotionObjective::equations(const EvaluatedState& evaluated) const {
  MotionEquations of_tags;
  for (std::size_t i = 0; i < evaluated.tags.size(); ++i)
    of_tags += equations_of_tag(active_.tags()[i], evaluated.tags[i]);
  return by_state(of_tags, evaluated.state);
}

std::vector<MotionEquations> MotionObjective::equations_of_tags(const EvaluatedState& evaluated) const {
  std::vector<MotionEquations> of_tags;
  for (std::size_t i = 0; i < evaluated.tags.size(); ++i)
    of_tags.push_back(equations_of_tag(active_.tags()[i], evaluated.tags[i]));
  return of_tags;
}

MotionEquations MotionObjective::by_state(MotionEquations of_tags, const MotionState& state) const {
  corners_.add_to(of_tags, state);
  const Matrix12d A = view_by_state(state);
  MotionEquations result{A.transpose() * of_tags.H * A, A.transpose() * of_tags.g};
  prior_.add_to(result, state);
  return result;
}

Matrix12d MotionObjective::view_by_state(const MotionState& state) const {
  Matrix12d A = Matrix12d::Zero();
  A.block<6, 6>(0, 0) = A.block<6, 6>(6, 6) = view_by_pose(state.pose, world_.mode);
  return A;
}

std::vector<TagEvidence> MotionObjective::evidence(const EvaluatedState& evaluated) const {
  std::vector<TagEvidence> tags;
  for (std::size_t i = 0; i < evaluated.tags.size(); ++i)
    tags.push_back(evidence_of(active_.tags()[i], evaluated.tags[i].misfit));
  return tags;
}

TagMisfit MotionObjective::misfit_of(const ActiveTag& tag, const PredictedPixels& predicted,
                                     double scale) const {
  return measure_misfit(tag.pixels, predicted, scale, &world_.scratch->weights);
}

void MotionObjective::begin(const MotionState& state, EvaluatedState& evaluated) const {
  evaluated.state = state;
  evaluated.cost = prior_.cost(state) + corners_.cost(state);
  evaluated.tags.clear();
}

MotionEquations MotionObjective::equations_of_tag(const ActiveTag& tag,
                                                  const EvaluatedState::Tag& evaluated) const {
  const auto& [prediction, misfit] = evaluated;
  if (misfit.colours.gain <= 0.0) return {};
  const TagNormalEquations one = linearise(tag.pixels, prediction, misfit.colours, tag.scale);
  return {tag.pixels.information_share() * one.H, tag.pixels.information_share() * one.g};
}

}  // namespace apriltrack
