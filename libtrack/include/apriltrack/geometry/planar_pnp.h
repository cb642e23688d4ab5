#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

#include "apriltrack/geometry/pose.h"

namespace apriltrack {

/// One pose that explains the four corners of a square: a local minimum of the angular error.
struct PlanarPose {
  /// Tag frame: origin at the centre, x right, y down, z INTO the tag.
  Pose T_camera_tag;
  /// Root mean square per axis (eight values) of the angle between seen and predicted corner rays. Times the
  /// focal length it is a reprojection error in pixels.
  double rms_error_rad = 0.0;
};

/// None, one or two poses, the smaller error first.
class PlanarPoses {
 public:
  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  const PlanarPose& operator[](std::size_t i) const { return poses_[i]; }
  const PlanarPose* begin() const { return poses_.data(); }
  const PlanarPose* end() const { return poses_.data() + size_; }

  /// Keeps the two smallest errors; a pose that coincides with a kept one (0.1 mrad, 1e-4 of its distance) is
  /// merged.
  void insert(const PlanarPose& pose);

 private:
  std::array<PlanarPose, 2> poses_;
  std::size_t size_ = 0;
};

/// Poses of a square tag from the rays to its four corners: BOTH minima of the planar ambiguity, each
/// converged.
///
/// A square seen from afar looks almost the same when it is mirrored about the line of sight: the two
/// explanations differ by the perspective alone, and noise may put the wrong one first (Schweighofer and
/// Pinz, "Robust pose estimation from a planar target", PAMI 2006). They are started in closed form from the
/// homography's derivative at the centre (Collins and Bartoli, "Infinitesimal plane-based pose estimation",
/// IJCV 2014) and refined on the rays.
///
/// rays_camera: unit rays to the corners, camera frame, bottom-left, bottom-right, top-right, top-left; any
/// lens, as long as the four lie within a hemisphere about their mean.  size_m: edge of the square, > 0. Only
/// poses with the tag's face towards the camera and every corner on its ray's side are returned: none for
/// corners that are collinear, coincident, mirrored, crossed or not finite. One when the two minima coincide
/// (frontal views).
PlanarPoses solve_planar_pnp(const std::array<Eigen::Vector3d, 4>& rays_camera, double size_m);

}  // namespace apriltrack
