#pragma once

#include <vector>

#include "uncertainty/linear_part.h"

namespace apriltrack {

/// From some moments on a tag is elsewhere.
struct Move {
  int tag = 0;
  std::vector<std::size_t> views = {};    ///< Of the tag, into Observations::views; in the order of time.
  std::vector<std::size_t> moments = {};  ///< Into these: the first of each new place.
  Eigen::VectorXd changes = {};           ///< Right perturbations of the tag's pose, six for each moment.
  double squares = 0.0;                   ///< Of the changes, over their spread.

  Vector6d first_change() const { return changes.head<6>(); }
};

/// What all views say of a tag that is elsewhere from any of some moments on, every other pose free to
/// follow, to first order. The poses are eliminated once, with a change of the tag's pose for each of the
/// stretches between two moments: what comes after a moment is a sum of those.
class MovesOfTag {
 public:
  /// part: outlives this; its poses are determined.
  MovesOfTag(const LinearPart& part, int tag);

  const Move& none() const { return none_; }
  /// With a further moment, the one that explains most; as it is where none explains more.
  Move with_one_more(const Move& move) const;
  /// As if the tag were elsewhere after every moment: what flaps, or drifts, does no two moments tell.
  Move all() const;

 private:
  void choose_moments();
  std::vector<ParameterView> columns() const;
  void sum_from_each_moment_on();
  std::vector<Eigen::Index> rows_of(const Move& move) const;
  void estimate(Move& move) const;

  const LinearPart* part_;
  Move none_;                            ///< Without a moment.
  std::vector<std::size_t> views_;       ///< Those of the tag, into the part's.
  std::vector<std::size_t> moments_;     ///< Into the tag's views.
  ParameterInformation from_moments_;    ///< Six numbers for each: the change that lasts from there on.
  Eigen::MatrixXd gradient_covariance_;  ///< Of these.
  Eigen::VectorXd own_;                  ///< What the tag's own views say of them, all else known.
};

}  // namespace apriltrack
