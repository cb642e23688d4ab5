#pragma once

#include <Eigen/Core>
#include <array>

namespace apriltrack {

/// Corner order everywhere: bottom-left, bottom-right, top-right, top-left of an upright tag (the AprilTag
/// library's).
inline constexpr int kNumCorners = 4;

/// Corners in the tag frame (x right, y down, z INTO the tag; origin at the centre), metres.
/// size_m: edge of the square whose corners the detector reports (tag36h11: outer edge of the black border).
inline std::array<Eigen::Vector3d, kNumCorners> tag_corners(double size_m) {
  const double h = 0.5 * size_m;
  return {Eigen::Vector3d(-h, h, 0.0), Eigen::Vector3d(h, h, 0.0), Eigen::Vector3d(h, -h, 0.0),
          Eigen::Vector3d(-h, -h, 0.0)};
}

}  // namespace apriltrack
