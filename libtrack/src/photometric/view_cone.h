#pragma once

#include <Eigen/Core>

#include "apriltrack/camera/camera_model.h"

namespace apriltrack {

/// Angle off the optical axis of an image's farthest pixel; pi where the lens model ends within the image:
/// anything may be seen there.
double max_view_angle_rad(const CameraModel& model, int width, int height);

/// Whether a ball around `centre` (camera frame) reaches into the cone of that angle: most tags of a room do
/// not, and cost no more than this.
bool may_be_in_view(const Eigen::Vector3d& centre, double radius, double max_angle_rad);

}  // namespace apriltrack
