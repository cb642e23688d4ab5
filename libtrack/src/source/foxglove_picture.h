#pragma once

#include <string>
#include <string_view>

#include "apriltrack/bag/bag_reader.h"
#include "ros_message.h"

namespace apriltrack {

// Foxglove's messages with pictures and cameras, as protobuf or JSON (foxglove/foxglove-sdk, schemas/proto
// and schemas/jsonschema), as the messages of ROS that say the same. A time that is missing is 0, as protobuf
// has it. All throw BadMessage.

inline constexpr std::string_view kFoxgloveRawImage = "foxglove.RawImage";
inline constexpr std::string_view kFoxgloveCompressedImage = "foxglove.CompressedImage";
inline constexpr std::string_view kFoxgloveCalibration = "foxglove.CameraCalibration";

/// Whether messages so encoded are read: "protobuf" and "json".
bool is_read_foxglove_encoding(std::string_view encoding);

/// What a JSON message has as text, which the views of a picture then are of.
struct PictureBytes {
  std::string data;    ///< base64 in the message.
  std::string format;  ///< Or encoding.
};

// The picture is a view of the message or of `storage`.

RosImage read_foxglove_raw_image(const BagTopic& topic, std::string_view bytes, PictureBytes& storage);
RosCompressedImage read_foxglove_compressed_image(const BagTopic& topic, std::string_view bytes,
                                                  PictureBytes& storage);
RosCameraInfo read_foxglove_calibration(const BagTopic& topic, std::string_view bytes);
/// Of any of these.
Timestamp read_foxglove_time(const BagTopic& topic, std::string_view bytes);

}  // namespace apriltrack
