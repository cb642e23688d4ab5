#include "picture_message.h"

#include "foxglove_picture.h"
#include "ros_pixels.h"

namespace apriltrack {
namespace {

bool is_foxglove_type(std::string_view type) {
  return type == kFoxgloveRawImage || type == kFoxgloveCompressedImage || type == kFoxgloveCalibration;
}

/// Holds no bytes of `storage`.
ImageValues own_values(ImageValues values, const PictureBytes& storage) {
  if (!storage.data.empty()) values.pixels = values.pixels.clone();
  return values;
}

PictureMessage read_foxglove_picture(const BagTopic& topic, std::string_view bytes) {
  PictureBytes storage;
  if (topic.type == kFoxgloveRawImage) {
    const RosImage image = read_foxglove_raw_image(topic, bytes, storage);
    return {image.stamp, own_values(values_of(image), storage)};
  }
  const RosCompressedImage image = read_foxglove_compressed_image(topic, bytes, storage);
  return {image.stamp, values_of(image)};
}

}  // namespace

bool is_picture_type(std::string_view type) {
  const std::string name = short_type(type);
  return name == "sensor_msgs/Image" || name == "sensor_msgs/CompressedImage" || name == kFoxgloveRawImage ||
         name == kFoxgloveCompressedImage;
}

bool is_camera_type(std::string_view type) {
  return short_type(type) == "sensor_msgs/CameraInfo" || type == kFoxgloveCalibration;
}

bool is_read_topic(const BagTopic& topic) {
  return is_foxglove_type(topic.type) ? is_read_foxglove_encoding(topic.encoding)
                                      : is_read_encoding(topic.encoding);
}

std::string_view read_encodings(std::string_view type) {
  return is_foxglove_type(type) ? "protobuf and json" : "ros1 and cdr";
}

PictureMessage read_picture_message(const BagTopic& topic, std::string_view bytes) {
  if (is_foxglove_type(topic.type)) return read_foxglove_picture(topic, bytes);
  if (short_type(topic.type) == "sensor_msgs/Image") {
    const RosImage image = read_image_message(topic, bytes);
    return {image.stamp, values_of(image)};
  }
  const RosCompressedImage image = read_compressed_image_message(topic, bytes);
  return {image.stamp, values_of(image)};
}

Timestamp read_picture_time(const BagTopic& topic, std::string_view bytes) {
  if (is_foxglove_type(topic.type)) return read_foxglove_time(topic, bytes);
  if (short_type(topic.type) == "sensor_msgs/Image") return read_image_message(topic, bytes).stamp;
  return read_compressed_image_message(topic, bytes).stamp;
}

RosCameraInfo read_camera_message(const BagTopic& topic, std::string_view bytes) {
  if (is_foxglove_type(topic.type)) return read_foxglove_calibration(topic, bytes);
  return read_camera_info_message(topic, bytes);
}

}  // namespace apriltrack
