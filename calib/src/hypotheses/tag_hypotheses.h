#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "hypotheses/evidence.h"
#include "hypotheses/robust_map.h"
#include "model/tag_finding.h"

namespace apriltrack {

/// One tag's views in a robust map.
struct TagViews {
  const PartTask& task;
  const RobustMap& map;
  const NullScale& scale;
  int tag = 0;
  std::vector<std::size_t> views = {};  ///< Into RobustMap::views; in the order of time.

  /// columns: of the tag's views.
  Score score(const std::vector<ParameterView>& columns) const {
    return Score(map.poses->eliminate_poses(columns));
  }
};

/// A fault that a tag may have, and what the views say of it.
struct TagHypothesis {
  int tag = 0;
  TagFinding::Kind kind = TagFinding::Kind::kLoose;
  Evidence evidence = {};
  std::vector<std::size_t> views = {};  ///< Of the tag, into Observations::views; in the order of time.
  std::vector<bool> is_at_second = {};  ///< Of these, where it has two places.

  double log_odds() const { return evidence.log_odds; }
};

// The faults, by what they do to the views. None where the views are too few to tell.

/// A print that is not the flat square of the stated size: another size, a bend.
std::vector<TagHypothesis> faults_of_shape(const TagViews& tag);
/// A tag that does not stay at its place: one change of place; a place of its own in each stretch of time.
std::vector<TagHypothesis> faults_of_motion(const TagViews& tag);
/// Two tags of one id, seen by turns.
std::vector<TagHypothesis> faults_of_identity(const TagViews& tag);

/// By size, aspect and twist; by a place of its own in each stretch of time, where there are two.
Score score_of_shape(const TagViews& tag);
std::optional<Score> score_of_motion(const TagViews& tag);
/// Of one move after each of the stretches, on average over these.
double mean_square_of_moves(const Score& motion, const ErrorScale& scale);

/// What the scores of most tags are as large by: errors that neighbouring views share (noise), those that
/// tags keep (bias), how tags differ in both, and errors that last longer than a stretch of time. An
/// empirical null (B. Efron, "Large-scale simultaneous hypothesis testing: the choice of a null hypothesis",
/// JASA 99, 2004).
NullScale null_scale(const PartTask& task, const RobustMap& map, const ParallelFor& parallel);

/// The likeliest of them. nullopt where four views or fewer show the tag.
std::optional<TagHypothesis> likeliest_fault(const PartTask& task, const RobustMap& map,
                                             const NullScale& scale, int tag);

}  // namespace apriltrack
