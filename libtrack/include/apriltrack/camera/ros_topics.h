#pragma once

#include <filesystem>
#include <map>
#include <string>

namespace apriltrack {

/// Kalibr's `rostopic` of each camera that has one, by the camera's name: the topic of its pictures in a bag.
/// Empty where the file is of another kind. Throws as read_cameras() does where it cannot be read or is no
/// YAML.
std::map<std::string, std::string> ros_topics(const std::filesystem::path& camera_file);

}  // namespace apriltrack
