#pragma once

#include <optional>
#include <vector>

#include "apriltrack/camera/camera_model.h"
#include "apriltrack/io/conversion_loss.h"
#include "apriltrack/io/yaml_reader.h"

namespace apriltrack {

/// How ROS rectifies the pictures of a camera (ros2/common_interfaces: sensor_msgs/msg/CameraInfo.msg): by
/// the 3x3 rotation R, and with the 3x4 projection P of the rectified picture. Of the second camera of a
/// stereo pair, P(0, 3) = -fx' B (P(1, 3) = -fy' B of one that is above the other), B metres between them.
/// Camera has none of this: notes R where it is not the identity, the left of P where it is not `pinhole`'s
/// matrix, and the baselines as the camera's place. Matrices of zeros state nothing. Throws
/// Error(kInvalidInput) of matrices that have not 9 and 12 numbers.
void note_rectification(const std::optional<YamlNode>& rectification,
                        const std::optional<YamlNode>& projection, const Pinhole& pinhole,
                        std::vector<ConversionLoss>& lost);

}  // namespace apriltrack
