#pragma once

#include <Eigen/Core>
#include <cmath>
#include <numbers>

#include "apriltrack/camera/camera_model.h"

namespace apriltrack {

/// Angle off the optical axis of an image's farthest pixel; pi where the lens model ends within the image:
/// anything may be seen there.
double max_view_angle_rad(const CameraModel& model, int width, int height);

/// Whether a ball around `centre` (camera frame) reaches into the cone of that angle: most tags of a room do
/// not, and cost no more than this.
bool may_be_in_view(const Eigen::Vector3d& centre, double radius, double max_angle_rad);

/// The same cone for many balls: a little wider behind the camera, and without a trigonometric function for
/// each.
class ViewCone {
 public:
  ViewCone() : ViewCone(std::numbers::pi) {}
  explicit ViewCone(double max_angle_rad) : cos_(std::cos(max_angle_rad)), sin_(std::sin(max_angle_rad)) {}

  /// Whether the ball reaches to where the cone's side is, or would be if it went on behind the camera.
  bool may_show(const Eigen::Vector3d& centre, double radius) const {
    return centre.head<2>().norm() * cos_ - centre.z() * sin_ <= radius;
  }

 private:
  double cos_, sin_;
};

}  // namespace apriltrack
