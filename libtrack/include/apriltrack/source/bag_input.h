#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "apriltrack/base/log.h"
#include "apriltrack/camera/camera.h"

namespace apriltrack {

/// A topic of pictures: sensor_msgs/Image or sensor_msgs/CompressedImage, of ROS 1 or ROS 2, or
/// foxglove.RawImage or foxglove.CompressedImage, as protobuf or JSON.
struct BagImageTopic {
  std::string name;
  std::string type;
  std::size_t count = 0;  ///< Messages.
};

/// Whether open_source() would read it as a bag: a file by its bytes, not by its name; a folder that rosbag2
/// recorded, unless it is a recording of another kind, or has pictures and no metadata.yaml.
bool is_bag_input(const std::string& input);

/// Those with messages, in the order of their names. Throws as open_bag() does.
std::vector<BagImageTopic> bag_image_topics(const std::string& input);

/// Names of topics that describe cameras (sensor_msgs/CameraInfo, foxglove.CameraCalibration). Throws as
/// open_bag() does.
std::vector<std::string> bag_camera_topics(const std::string& input);

/// The camera that a bag itself describes: by the sensor_msgs/CameraInfo or
/// foxglove.CameraCalibration beside the pictures (/left/camera_info or /left/calibration of
/// /left/image_raw), for pictures of the size that binning and region of interest leave. Of a rectified topic
/// (image_rect...) it is the projection matrix without distortion. Its name is cam0. topic: of the pictures;
/// empty: the only one there is. nullopt where there is no such message, or the camera was not calibrated (K
/// is zero), which the log hears of, as of messages that differ (up to nine, evenly spread, are looked at;
/// the first one holds). Throws as open_source() does, and Error(kInvalidInput) for a lens model that is not
/// supported and numbers that are no camera's.
std::optional<Camera> bag_camera(const std::string& input, const std::string& topic = "",
                                 const LogSink& log = silent_log());

}  // namespace apriltrack
