#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "apriltrack/bag/bag_reader.h"
#include "apriltrack/base/timestamp.h"

namespace apriltrack {

/// A message that is not as its type says.
class BadMessage : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Fields of sensor_msgs/Image; views of the message.
struct RosImage {
  Timestamp stamp;  ///< header.stamp
  std::uint32_t height = 0;
  std::uint32_t width = 0;
  std::string_view encoding;
  bool is_big_endian = false;
  std::uint32_t step = 0;  ///< Bytes from row to row.
  std::string_view data;
};

/// Fields of sensor_msgs/CompressedImage; views of the message.
struct RosCompressedImage {
  Timestamp stamp;
  std::string_view format;
  std::string_view data;
};

/// Fields of sensor_msgs/CameraInfo.
struct RosCameraInfo {
  std::uint32_t height = 0;
  std::uint32_t width = 0;
  std::string distortion_model;
  std::vector<double> d;
  std::vector<double> k;  ///< 9, row by row: of the pictures as the sensor gives them.
  std::vector<double> p;  ///< 12, row by row: of rectified ones.
  std::uint32_t binning_x = 0;
  std::uint32_t binning_y = 0;
  std::uint32_t roi_x = 0;
  std::uint32_t roi_y = 0;
  std::uint32_t roi_height = 0;
  std::uint32_t roi_width = 0;

  bool operator==(const RosCameraInfo&) const = default;
};

/// What messages of a pose have in common.
struct RosPose {
  Timestamp stamp;
  Eigen::Vector3d position;
  Eigen::Quaterniond orientation;
};

/// geometry_msgs/TransformStamped with the frames that it names: the pose is T_parent_child.
struct RosTransform {
  RosPose pose;
  std::string parent;
  std::string child;
};

/// "sensor_msgs/Image" for that and for "sensor_msgs/msg/Image".
std::string short_type(std::string_view type);

/// Whether messages so encoded are read: "ros1" (ROS 1) and "cdr" (ROS 2).
bool is_read_encoding(std::string_view encoding);

// All read both encodings, CDR in either byte order, and throw BadMessage.
RosImage read_image_message(const BagTopic& topic, std::string_view bytes);
RosCompressedImage read_compressed_image_message(const BagTopic& topic, std::string_view bytes);
RosCameraInfo read_camera_info_message(const BagTopic& topic, std::string_view bytes);
/// Of any type that is_ros_pose_type() knows.
RosPose read_pose_message(const BagTopic& topic, std::string_view bytes);

/// The poses of nav_msgs/Path, each with a time of its own.
std::vector<RosPose> read_path_message(const BagTopic& topic, std::string_view bytes);
/// Of tf2_msgs/TFMessage, or tf/tfMessage of older ROS 1, which is the same. Names of frames lose the slash
/// that they began with in tf.
std::vector<RosTransform> read_tf_message(const BagTopic& topic, std::string_view bytes);

/// nav_msgs/Path
bool is_ros_path_type(std::string_view type);
/// tf2_msgs/TFMessage, tf/tfMessage
bool is_tf_type(std::string_view type);
/// geometry_msgs/PoseStamped, PoseWithCovarianceStamped and TransformStamped, nav_msgs/Odometry.
bool is_ros_pose_type(std::string_view type);

}  // namespace apriltrack
