#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "apriltrack/calib/map_constraints.h"
#include "apriltrack/geometry/pose.h"

namespace apriltrack {

/// A constraint with small whole numbers in place of names.
struct BoundConstraint {
  const MapConstraint* constraint = nullptr;
  std::size_t index = 0;  ///< Among all that were given.
  std::vector<int> tags;  ///< As tags_of() lists them.
  int plane = -1;         ///< Of a coplanar group: into ConstraintState::T_held_plane.
};

/// What constraints speak of.
struct ConstraintState {
  std::vector<Pose> T_held_tag;
  Pose T_map_held;
  std::vector<Pose> T_held_plane;  ///< z along the normals of the tags in it.
};

/// How many numbers it tells.
Eigen::Index num_rows(const MapConstraint& constraint);

/// One number that was measured.
struct ConstraintRow {
  std::string name;
  std::string unit;  ///< "m" or "rad".
  double measured = 0.0;
  double sigma = 1.0;
};

/// Of a plane: along its normal, and about its x and y axes.
inline constexpr int kPlaneUnknowns = 3;
Pose moved_plane(const Pose& T_held_plane, const Eigen::Vector3d& step);

/// A constraint near where it was linearised: residual + sum by_tag xi_tag + by_frame xi_frame + by_plane
/// step are independent numbers of unit variance; xi right perturbations of T_held_tag and T_map_held. The
/// residual is (what the state says - what was measured) / sigma.
struct LinearConstraint {
  Eigen::VectorXd residual;
  std::vector<Eigen::MatrixXd> by_tag;  ///< As BoundConstraint::tags, 6 columns each.
  Eigen::MatrixXd by_frame;             ///< 6 columns, all zero where it is of tags among each other.
  Eigen::MatrixXd by_plane;             ///< 3 columns; empty where there is none.
  std::vector<ConstraintRow> rows;
};

LinearConstraint linearise(const BoundConstraint& bound, const ConstraintState& state);

/// The rotation vector, 2 numbers across `target`, that takes `target` to `direction`; both of unit length.
/// by_turn: by a small rotation of `direction`. Right up to half a turn, where it is pi about some axis.
Eigen::Vector2d direction_error(const Eigen::Vector3d& direction, const Eigen::Vector3d& target,
                                Eigen::Matrix<double, 2, 3>* by_turn);

}  // namespace apriltrack
