#pragma once

#include <string>
#include <vector>

#include "apriltrack/base/log.h"
#include "apriltrack/base/timestamp.h"
#include "apriltrack/geometry/pose.h"

namespace apriltrack {

struct BagPose {
  Timestamp timestamp;  ///< Of the message's header.
  Pose pose;            ///< In the frame that the message names.
};

/// Which poses of a bag are meant; empty: the only ones there are.
struct BagPoseChoice {
  std::string topic;
  std::string transform;  ///< "PARENT:CHILD" of transforms: T_parent_child.
};

/// The poses of a topic, in the order of the bag: geometry_msgs/PoseStamped and PoseWithCovarianceStamped,
/// nav_msgs/Odometry, geometry_msgs/TransformStamped (of ROS 1 or ROS 2), or foxglove.PoseInFrame as JSON;
/// where there is none of these, or by its name, the last nav_msgs/Path, or the transforms between two frames
/// of tf2_msgs/TFMessage or tf/tfMessage, of all such topics where none is named. Transforms are not chained;
/// one that is said again is one. choice.topic: empty: the only one of these; where there is one
/// foxglove.PoseInFrame beside others, as `track` writes it, that one. log: hears of what is damaged, and of
/// messages that are left out, for they are not as their type says, have no times, or a quaternion whose
/// length is not 1. Throws as open_bag() does, and Error(kInvalidInput) that lists the topics, or the pairs
/// of frames, where there is none that fits, or several do, and where all messages would be left out.
std::vector<BagPose> read_bag_poses(const std::string& input, const BagPoseChoice& choice = {},
                                    const LogSink& log = silent_log());

}  // namespace apriltrack
