#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "foreign_map.h"

namespace apriltrack {

/// Of {position, rotation}, a rotation vector, or of {center, rotvec}, as earlier versions of TagSLAM call
/// them; nullopt where it has neither.
std::optional<Pose> tagslam_pose(const YamlNode& node);

/// By TagSLAM's `bits`, data bits along an edge; fails at the node where no family has so many.
std::string family_of_bits(const YamlNode& bits);
/// nullopt of a family that TagSLAM does not know.
std::optional<int> bits_of_family(std::string_view family);

}  // namespace apriltrack
