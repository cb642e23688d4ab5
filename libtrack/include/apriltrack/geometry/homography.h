#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

namespace apriltrack {

/// The homography H with `image ~ H * plane` in homogeneous coordinates, scaled to unit Frobenius norm and
/// with a positive third coordinate at the mean plane point.
///
/// Least squares of the algebraic error after both point sets are centred and scaled (normalised DLT:
/// Hartley, "In defense of the eight-point algorithm", PAMI 1997). Any length unit. Requires as many image as
/// plane points. nullopt for fewer than four points, for points that are not finite, and where they do not
/// determine H (three of four on a line, coincident points).
std::optional<Eigen::Matrix3d> estimate_homography(std::span<const Eigen::Vector2d> plane_points,
                                                   std::span<const Eigen::Vector2d> image_points);

}  // namespace apriltrack
