#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <map>
#include <span>
#include <vector>

#include "constraints/constraint_equations.h"

namespace apriltrack {

/// What the images alone say of the tags that constraints name.
struct ConstraintPrior {
  std::vector<Pose> T_held_tag;  ///< Of all tags.
  /// Where the six rows of a tag start in `covariance`; none of the held tag, which has no error.
  std::map<int, Eigen::Index> offsets;
  Eigen::MatrixXd covariance;  ///< Of right perturbations, all together.
};

/// The map with constraints, as a Gaussian product of what the images say and what was measured
/// (docs/algorithms/calibration.md, equations 12 to 14). Rows are those of all constraints, one after
/// another.
struct ConstrainedFit {
  bool has_settled = false;
  ConstraintState state;
  std::vector<LinearConstraint> constraints;
  std::vector<Eigen::Index> first_rows;
  Eigen::SparseMatrix<double> by_tags;  ///< A: columns as ConstraintPrior::offsets.
  Eigen::VectorXd
      disagreement;      ///< What the images alone say less what was measured, whitened; unknowns at `state`.
  Eigen::VectorXd push;  ///< M times the disagreement: the tags moved by - covariance A' push.
  /// M: of the disagreement, when the unknowns (frame, planes) take what they can.
  Eigen::MatrixXd precision;
  bool has_frame = false;
  Matrix6d frame_covariance = Matrix6d::Zero();  ///< Of the right perturbation of T_map_held.
  /// cov(tags, frame) = - covariance A' this.
  Eigen::Matrix<double, Eigen::Dynamic, 6> frame_coupling;
  /// Directions of T_map_held's right perturbation that no constraint determines, a column each.
  Eigen::Matrix<double, 6, Eigen::Dynamic> open_directions;
};

/// start: poses of tags are not read from it, frame and planes are.
ConstrainedFit fit_constraints(std::span<const BoundConstraint> constraints, const ConstraintPrior& prior,
                               ConstraintState start);

/// The equations of `constraints` at `state`, nothing moved; for what constraints would say that are not in a
/// fit.
ConstrainedFit look_at_constraints(std::span<const BoundConstraint> constraints, const ConstraintPrior& prior,
                                   const ConstraintState& state);

/// Variance of each row, by the error of what was measured and by those of the tags.
Eigen::VectorXd row_variances(const BoundConstraint& bound, const LinearConstraint& linear,
                              const ConstraintPrior& prior);

/// A generalised inverse of a symmetric positive semidefinite matrix by blocks of three: an unknown moves
/// only for what the blocks before it cannot explain, so a map is shifted rather than turned.
Eigen::MatrixXd blockwise_inverse(const Eigen::MatrixXd& matrix);

}  // namespace apriltrack
