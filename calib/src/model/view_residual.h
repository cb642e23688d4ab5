#pragma once

#include "observations/observations.h"

namespace apriltrack {

using Matrix8x6d = Eigen::Matrix<double, 8, 6>;

/// Reprojection errors of one view (projected minus observed, the edge offset undone, px, x0 y0 x1 ...) and
/// their derivatives by right perturbations of the two poses; false when a corner falls behind the camera or
/// outside the lens model's domain. residual and Jacobians are not whitened. Null pointers: not wanted.
bool view_residual(const RigCamera& camera, double size_m, const TagView& view, const Pose& T_map_rig,
                   const Pose& T_map_tag, Vector8d* residual_px, Matrix8x6d* by_rig, Matrix8x6d* by_tag);

}  // namespace apriltrack
