#pragma once

#include <string>
#include <string_view>

#include "apriltrack/base/timestamp.h"
#include "apriltrack/geometry/pose.h"

namespace apriltrack {

/// Ours as ROS has it (geometry_msgs/PoseWithCovariance): x, y, z, and small rotations about the fixed axes
/// X, Y, Z, all along the axes of the frame that the pose is given in. covariance: of the right perturbation
/// of T_frame_pose, [translation; rotation], which is along the axes of the pose itself.
Matrix6d ros_covariance(const Pose& T_frame_pose, const Matrix6d& covariance);

/// "geometry_msgs/msg/PoseWithCovarianceStamped"
std::string_view ros_pose_type();
/// Its definition, those of its members behind it, as "ros2msg" wants it.
std::string_view ros_pose_definition();
/// A message of that type, little-endian CDR; covariance: as ros_covariance() gives it. Throws
/// Error(kInvalidInput) for a time before 1970 or after January 2038, which ROS cannot hold.
std::string ros_pose_cdr(Timestamp time, std::string_view frame, const Pose& T_frame_pose,
                         const Matrix6d& covariance);

}  // namespace apriltrack
