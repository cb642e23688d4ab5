#pragma once

#include <Eigen/Core>
#include <optional>

#include "apriltrack/photometric/photometric_world.h"

namespace apriltrack {

using PixelJacobian = Eigen::Matrix<double, 2, 6>;

/// d pixel / d xi of a point of the map, xi the left perturbation of the view (T_camera_map); none where the
/// camera does not see it.
std::optional<PixelJacobian> pixel_by_view(const CameraModel& model, const Pose& view,
                                           const Eigen::Vector3d& point_map);

/// How points of the map move in the image with the tracked pose, by its right perturbation.
class PixelsByPose {
 public:
  PixelsByPose(const PhotometricWorld& world, const Pose& pose)
      : model_(world.model),
        view_(camera_from_map(pose, world.mode)),
        left_by_right_(view_by_pose(pose, world.mode)) {}

  /// None where the camera does not see the point.
  std::optional<PixelJacobian> of(const Eigen::Vector3d& point_map) const {
    const auto by_view = pixel_by_view(model_, view_, point_map);
    if (!by_view) return std::nullopt;
    return *by_view * left_by_right_;
  }

 private:
  const CameraModel& model_;
  Pose view_;
  Matrix6d left_by_right_;
};

}  // namespace apriltrack
