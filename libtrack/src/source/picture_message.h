#pragma once

#include <string>
#include <string_view>

#include "apriltrack/bag/bag_reader.h"
#include "apriltrack/base/timestamp.h"
#include "image_values.h"
#include "ros_message.h"

namespace apriltrack {

// Messages with pictures and cameras, whoever's they are.

/// "sensor_msgs/Image, sensor_msgs/CompressedImage, foxglove.RawImage, ..."
inline constexpr std::string_view kPictureTypes =
    "sensor_msgs/Image, sensor_msgs/CompressedImage, foxglove.RawImage, foxglove.CompressedImage";

/// Whether its messages are pictures, by their type.
bool is_picture_type(std::string_view type);
/// Whether its messages tell of a camera, by their type: sensor_msgs/CameraInfo, foxglove.CameraCalibration.
bool is_camera_type(std::string_view type);
/// Whether messages of such a type are read in the encoding that the topic has.
bool is_read_topic(const BagTopic& topic);
/// "ros1 and cdr"; of Foxglove's types "protobuf and json".
std::string_view read_encodings(std::string_view type);

struct PictureMessage {
  Timestamp stamp;
  ImageValues values;  ///< Of an uncompressed picture a view of the message, unless it has been converted.
};

// Of topics that are read. All throw BadMessage.
PictureMessage read_picture_message(const BagTopic& topic, std::string_view bytes);
Timestamp read_picture_time(const BagTopic& topic, std::string_view bytes);
RosCameraInfo read_camera_message(const BagTopic& topic, std::string_view bytes);

}  // namespace apriltrack
