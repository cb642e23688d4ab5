#pragma once

#include <string>
#include <string_view>

#include "apriltrack/bag/bag_reader.h"
#include "apriltrack/io/yaml_reader.h"
#include "ros_message.h"

namespace apriltrack {

// Foxglove's messages as JSON (foxglove/foxglove-sdk, schemas/jsonschema). Readers throw Error(kInvalidInput)
// that begins with `where` and names the field. where: what messages call the message.

inline constexpr std::string_view kFoxglovePose = "foxglove.PoseInFrame";

/// Whether its messages are of this type, and JSON.
bool is_foxglove(const BagTopic& topic, std::string_view type);

/// A time of Foxglove's JSON, whose seconds are from 0 on.
Timestamp read_foxglove_time(const YamlNode& time);
RosPose read_foxglove_pose(std::string_view bytes, const std::string& where);

}  // namespace apriltrack
