#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "apriltrack/geometry/pose.h"

namespace apriltrack {

/// What constraints change of the covariance of all tags together. Six rows for each tag of the map; empty
/// where no constraint is used.
struct JointChange {
  Eigen::MatrixXd lost_root;            ///< Relative to the held tag, it is less by this times its transpose.
  Eigen::MatrixXd with_rows;            ///< Its product with the constraints' rows A, transposed.
  Eigen::SparseMatrix<double> by_tags;  ///< A: columns as the rows here.
  Eigen::MatrixXd precision;            ///< M of equation 13.
  // Where the map's frame was measured, its errors come on top:
  Eigen::MatrixXd by_frame;    ///< Right perturbations of the tags by that of T_map_held.
  Eigen::MatrixXd with_frame;  ///< Covariance of the tags with the frame.
  Eigen::MatrixXd frame_push;  ///< The frame moves by minus this, transposed, times what A makes of the tags.
  Matrix6d frame_covariance = Matrix6d::Zero();

  /// covariance: of T_held_tag; becomes that of T_map_tag.
  void apply(Eigen::MatrixXd& covariance) const;
  /// How the poses of T_map_tag follow what those of T_held_tag followed so, a column each.
  Eigen::MatrixXd follow(const Eigen::MatrixXd& columns) const;
};

}  // namespace apriltrack
