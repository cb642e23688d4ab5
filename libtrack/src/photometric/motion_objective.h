#pragma once

#include <optional>
#include <vector>

#include "active_tags.h"
#include "apriltrack/motion/motion_state.h"
#include "apriltrack/photometric/motion_fit.h"
#include "apriltrack/photometric/photometric_world.h"
#include "motion_equations.h"
#include "motion_terms.h"
#include "tag_photometry.h"

namespace apriltrack {

/// A state with what it makes of the chosen pixels.
struct EvaluatedState {
  struct Tag {
    TagPrediction prediction;
    TagMisfit misfit;
  };
  MotionState state;
  double cost = 0.0;
  std::vector<Tag> tags;  ///< In the order of the active ones; not all where the evaluation broke off.
};

/// What a fit makes least of: prior, corners, and the pixels chosen for a state, as a function of the state
/// (docs/algorithms/blur_tracker.md, equation 4).
class MotionObjective {
 public:
  /// What is given is referred to.
  MotionObjective(PhotometricWorld& world, const PhotometricFrame& frame,
                  const std::optional<MotionBelief>& prior, const std::vector<CornerObservation>& corners);

  /// The pixels that all states are judged by until others are chosen, and their scales, as `state` shows
  /// them.
  void choose_pixels(const MotionState& state, const ActiveTagsOptions& options);
  bool has_pixels() const { return !active_.tags().empty(); }
  /// Whether a tag has moved by a pixel of the level since its pixels were chosen.
  bool has_left_its_pixels(const EvaluatedState& evaluated) const;
  /// How far a tag's picture goes from where its pixels were chosen, pixels of level 0; infinite where one
  /// turns its back.
  double largest_move_px(const MotionState& to) const;
  int level() const { return options_.level; }

  /// The state that the pixels were chosen for.
  void evaluate_chosen(EvaluatedState& evaluated) const;
  /// Breaks off where the cost reaches `limit`; infinite where a tag turns its back.
  void evaluate(const MotionState& state, double limit, EvaluatedState& evaluated) const;

  /// Of everything, by the state.
  MotionEquations equations(const EvaluatedState& evaluated) const;
  /// Of each tag's pixels, by the view and its rate.
  std::vector<MotionEquations> equations_of_tags(const EvaluatedState& evaluated) const;
  /// of_tags: the sum of theirs; with the corners, by the state, with the prior.
  MotionEquations by_state(MotionEquations of_tags, const MotionState& state) const;
  /// From a step of the state to one of the view and its rate.
  Matrix12d view_by_state(const MotionState& state) const;

  std::vector<TagEvidence> evidence(const EvaluatedState& evaluated) const;

 private:
  TagMisfit misfit_of(const ActiveTag& tag, const PredictedPixels& predicted, double scale) const;
  void begin(const MotionState& state, EvaluatedState& evaluated) const;
  MotionEquations equations_of_tag(const ActiveTag& tag, const EvaluatedState::Tag& evaluated) const;

  PhotometricWorld& world_;
  const PhotometricFrame& frame_;
  PriorTerm prior_;
  CornerTerm corners_;
  ActiveTags& active_;
  ActiveTagsOptions options_;       ///< That the pixels were chosen by,
  MotionState chosen_for_;          ///< the state,
  std::vector<TagMisfit> misfits_;  ///< and the active tags there.
};

}  // namespace apriltrack
