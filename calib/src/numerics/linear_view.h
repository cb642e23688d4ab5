#pragma once

#include <Eigen/Core>
#include <vector>

#include "apriltrack/geometry/pose.h"

namespace apriltrack {

/// What one view of a tag says of its frame's pose and the tag's, near where it was linearised:
/// residual + by_rig xi_rig + by_tag xi_tag are independent numbers of unit variance, xi right perturbations
/// of T_map_rig and T_map_tag. Corners give eight of them, a picture six.
struct LinearView {
  static constexpr int kMostRows = 8;
  using Residual = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostRows, 1>;
  using ByPose = Eigen::Matrix<double, Eigen::Dynamic, 6, 0, kMostRows, 6>;
  using ByError = Eigen::Matrix<double, Eigen::Dynamic, 8, 0, kMostRows, 8>;

  int tag = 0;
  int frame = 0;
  int camera = 0;
  Residual residual;
  ByPose by_rig, by_tag;
  /// By the eight independent errors of unit variance that the tag has in all of its views.
  ByError by_error;
};

}  // namespace apriltrack
