#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>

#include "apriltrack/geometry/pose.h"
#include "apriltrack/tags/tag_map.h"

namespace apriltrack {

/// "x y z", exact.
std::string exact_numbers(const Eigen::Vector3d& v);
/// "x y z qx qy qz qw", exact.
std::string exact_numbers(const Pose& pose);

/// "tag36h11_7": for names in which a slash has a meaning.
std::string flat_name(const TagKey& key);

/// Letters, digits, underscores: for names of links and models.
std::string plain_name(std::string_view text);

/// What the map's frame is called where names are plain, and no tag is called so (flat_name()).
std::string plain_frame_name(const TagMap& map);

}  // namespace apriltrack
