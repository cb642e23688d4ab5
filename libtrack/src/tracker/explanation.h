#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "apriltrack/photometric/motion_fit.h"
#include "blur_corners.h"
#include "motion_memory.h"

namespace apriltrack {

/// A state that explains a frame, and why.
struct Explanation {
  MotionFit fit;
  MotionHypothesis prior;
  bool is_cold = false;     ///< The prior is that of a detection alone, not of the motion so far.
  double prior_cost = 0.0;  ///< -log of the prior's density over its peak.
  /// How well the prior knew where to look: standard deviation of an explained tag's place in the image over
  /// the tag's size there, of the tag that it knew best. 0 when it is cold.
  double prior_spread = 0.0;
  /// Of the pose: what the acceleration within the exposure leaves open.
  Matrix6d bend_covariance = Matrix6d::Zero();
  TagVotes votes;
  double correlation = 0.0;  ///< What most of the quorum reaches: one tag behind something lowers it not.
  /// Log-likelihood of the pixels and, within limits, of the prior.
  double score = 0.0;
  double sensitivity = 1.0;  ///< Of its frame.
  /// How the map is turned to what lights it, which stands still: with a body before a fixed camera it turns.
  Eigen::Quaterniond R_light_map = Eigen::Quaterniond::Identity();

  bool is_explained() const { return correlation >= TagEvidence::kExplained; }
  /// So far from what the prior expects that one of the two is wrong: nine standard deviations.
  bool is_beyond_prior() const { return !(prior_cost <= 0.5 * 9.0 * 9.0); }
};

/// -log of the prior's density at the state over its peak.
double prior_cost(const MotionBelief& prior, const MotionState& state);
/// What it takes off a score: beyond 30, its Gaussian is not to be trusted.
inline constexpr double kMaxScoredPriorCost = 30.0;
inline double scored_prior_cost(double prior_cost) {
  return prior_cost < kMaxScoredPriorCost ? prior_cost : kMaxScoredPriorCost;
}
/// What a motion that went on as expected costs, half of the squares of twelve standard deviations: on the
/// average.
inline constexpr double kUsualPriorCost = 6.0;
/// One in 200 costs more.
inline constexpr double kMaxExpectedPriorCost = 14.0;

/// As Explanation::prior_spread.
double prior_spread(const PhotometricWorld& world, const MotionBelief& prior, const MotionFit& fit);

/// Of a tag that a state should show: more than a sliver, and not explained.
bool is_missed(const TagEvidence& tag);

/// Where the motion so far and the turn that was seen since agree on.
bool is_where_seen(const Explanation& explanation);

/// What the motion of a tag alone that is not read may cost: seven standard deviations.
inline constexpr double kMaxLonePriorCost = 0.5 * 7.0 * 7.0;

/// A tag alone that is not read, and not where or as the motion so far expects it: its tilt may be that of
/// another motion, or of its reverse.
bool surprises_alone(const Explanation& explanation);

/// A tag alone, of which something covers a part, perhaps: what is left may be a whole one that is tilted.
bool rests_on_part_of_a_tag(const Explanation& explanation);

/// Well enough to look no further.
bool is_well_explained(const Explanation& explanation);

/// Of a tag's corner during the exposure.
double longest_path_px(const Explanation& explanation);

/// The same places in the other order: the same picture, so that the pixels' equations are the same but for
/// the sign of the velocity. What the prior pulls differs, and moves the state by one step of Newton.
Explanation path_reversed(const Explanation& explanation);

/// What lies beyond its prior is no better for explaining the pixels: one of the two is wrong.
bool is_better(const Explanation& a, const Explanation& b);
/// Best first.
void sort_by_score(std::vector<Explanation>& found);

}  // namespace apriltrack
