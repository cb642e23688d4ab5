#include "view_cone.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace apriltrack {
namespace {

double angle_off_axis_rad(const Eigen::Vector3d& direction) {
  return std::atan2(direction.head<2>().norm(), direction.z());
}

}  // namespace

/// The image's corners look farthest off the axis, but for what tangential distortion adds: hence the margin.
double max_view_angle_rad(const CameraModel& model, int width, int height) {
  constexpr double kMargin_rad = 0.05;
  double angle_rad = 0.0;
  for (const Eigen::Vector2d& corner :
       {Eigen::Vector2d(0, 0), Eigen::Vector2d(width - 1, 0), Eigen::Vector2d(0, height - 1),
        Eigen::Vector2d(width - 1, height - 1)}) {
    const auto ray = model.unproject(corner);
    if (!ray) return std::numbers::pi;
    angle_rad = std::max(angle_rad, angle_off_axis_rad(*ray));
  }
  return angle_rad + kMargin_rad;
}

bool may_be_in_view(const Eigen::Vector3d& centre, double radius, double max_angle_rad) {
  const double distance = centre.norm();
  return distance <= radius || angle_off_axis_rad(centre) - std::asin(radius / distance) <= max_angle_rad;
}

}  // namespace apriltrack
