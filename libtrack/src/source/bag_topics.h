#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "apriltrack/bag/bag_reader.h"

namespace apriltrack {

/// Whether its messages are pictures: kPictureTypes.
bool is_image_topic(const BagTopic& topic);

/// Indices of the topics with pictures and messages, in the order of their names.
std::vector<std::size_t> image_topics(const BagReader& bag);

/// "/left/image_raw (sensor_msgs/Image, 8 messages)".
std::string description_of(const BagTopic& topic);

/// The topic called `wanted`, or the only one with pictures where `wanted` is empty; messages call the bag
/// `name`. Throws Error(kInvalidInput) that lists the topics there are, Error(kIo) where there are none at
/// all.
std::size_t choose_image_topic(const BagReader& bag, const std::string& name, const std::string& wanted);

/// The topic that tells of the camera beside these pictures, called camera_info, or calibration as Foxglove's
/// examples call it; nullopt where there is none with messages.
std::optional<std::size_t> camera_info_topic(const BagReader& bag, const BagTopic& images);

/// Whether its pictures are rectified: the last part of its name but the transport's begins with image_rect.
bool is_rectified(const BagTopic& images);

}  // namespace apriltrack
