#pragma once

#include "apriltrack/geometry/pose.h"

namespace apriltrack {

/// What is tracked: the camera in a world of tags, or a rigid body of tags before the camera.
enum class TrackMode {
  kEgo,    ///< Poses are T_world_camera.
  kJoint,  ///< Poses are T_camera_body.
};

/// The transform that takes points of the map into the camera, whichever of the two moves.
inline Pose camera_from_map(const Pose& pose, TrackMode mode) {
  return mode == TrackMode::kEgo ? pose.inverse() : pose;
}

/// The inverse of camera_from_map.
inline Pose pose_from_camera(const Pose& T_camera_map, TrackMode mode) {
  return mode == TrackMode::kEgo ? T_camera_map.inverse() : T_camera_map;
}

/// From a right perturbation of the pose to a LEFT one of the camera's view of the map:
/// camera_from_map(pose * exp(xi), mode) = exp(view_by_pose(pose, mode) * xi) * camera_from_map(pose, mode).
inline Matrix6d view_by_pose(const Pose& pose, TrackMode mode) {
  return mode == TrackMode::kEgo ? Matrix6d(-Matrix6d::Identity()) : pose.adjoint();
}

/// Covariance of the right perturbation of pose_from_camera(T_camera_map, mode), from that of T_camera_map:
/// (T exp(xi))^-1 = T^-1 exp(-adjoint(T) xi).
inline Matrix6d pose_covariance_from_camera(const Pose& T_camera_map, const Matrix6d& covariance,
                                            TrackMode mode) {
  Matrix6d moved = covariance;
  if (mode == TrackMode::kEgo) {
    const Matrix6d adjoint = T_camera_map.adjoint();
    moved = adjoint * covariance * adjoint.transpose();
  }
  return moved;
}

}  // namespace apriltrack
