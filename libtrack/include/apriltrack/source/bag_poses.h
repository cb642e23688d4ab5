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

/// The poses of a topic, in the order of the bag: geometry_msgs/PoseStamped and PoseWithCovarianceStamped,
/// nav_msgs/Odometry, geometry_msgs/TransformStamped (of ROS 1 or ROS 2), or foxglove.PoseInFrame as JSON.
/// topic: empty: the only one of these; where there is one foxglove.PoseInFrame beside others, as `track`
/// writes it, that one. log: hears of what is damaged. Throws as open_bag() does, and Error(kInvalidInput)
/// that lists the topics where none is of these types, or several are, and for a message that is not as its
/// type says, or whose quaternion has not length 1.
std::vector<BagPose> read_bag_poses(const std::string& input, const std::string& topic = "",
                                    const LogSink& log = silent_log());

}  // namespace apriltrack
