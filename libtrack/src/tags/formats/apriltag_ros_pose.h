#pragma once

#include <string>

#include "foreign_map.h"

namespace apriltrack {

/// x, y, z, qw, qx, qy, qz of a bundle's tag, zeros and qw = 1 where they are missing.
Pose pose_of_bundle_tag(const YamlNode& node);
/// "x: 0.1, ..., qz: 0.0", joined by `between`.
std::string text_of_bundle_pose(const Pose& T_map_tag, const std::string& between);

/// Metres.
double size_of_bundle_tag(const YamlNode& node);

/// What to say of a file that knows sizes and no places.
[[noreturn]] void fail_without_poses(const std::string& file, const std::string& project, std::size_t tags);

}  // namespace apriltrack
