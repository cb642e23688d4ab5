#pragma once

#include <array>
#include <string>
#include <string_view>

#include "apriltrack/geometry/pose.h"

namespace apriltrack {

/// Columns of a pose in TUM files and frame logs, in their order.
inline constexpr std::array<std::string_view, 7> kPoseColumns = {"tx", "ty", "tz", "qx", "qy", "qz", "qw"};

/// A pose of the values of kPoseColumns. Throws Error(kInvalidInput) at `where` when the quaternion's length
/// is not 1.
Pose pose_of_columns(const std::array<double, kPoseColumns.size()>& values, const std::string& where);

}  // namespace apriltrack
