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

}  // namespace apriltrack
