#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>

namespace apriltrack {

// Rotations that a file states, whose numbers were rounded when it was written.

/// Largest entry of |R R^T - I|: about twice the largest error of R's numbers; not finite where R is not.
double rotation_defect(const Eigen::Matrix3d& matrix);

/// The nearest rotation (nearest_rotation()); nullopt of a mirror image, and where rotation_defect() is not
/// within `tolerance`.
std::optional<Eigen::Matrix3d> rounded_rotation(const Eigen::Matrix3d& matrix, double tolerance);

/// Whether its length is 1 within `tolerance`.
bool is_rounded_rotation(const Eigen::Quaterniond& quaternion, double tolerance);

}  // namespace apriltrack
