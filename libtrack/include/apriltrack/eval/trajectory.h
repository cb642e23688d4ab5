#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apriltrack/base/timestamp.h"
#include "apriltrack/geometry/pose.h"

namespace apriltrack {

struct TimedPose {
  Timestamp timestamp;
  Pose pose;  ///< T_world_camera (ego) or T_camera_body (joint).
};

/// Sorted by time, each time once.
using Trajectory = std::vector<TimedPose>;

/// Reads TUM format, `timestamp tx ty tz qx qy qz qw`; `#` starts a comment.
/// Throws Error(kIo) when unreadable, Error(kInvalidInput) with file and line when a row is wrong.
Trajectory read_tum(const std::filesystem::path& path);
/// Times as integer seconds and nanoseconds, numbers with as many digits as tell them exactly. Throws
/// Error(kIo); an existing file is replaced only when the new one is complete.
void write_tum(const std::filesystem::path& path, const Trajectory& trajectory);
/// One line of it, its end included.
std::string tum_line(const TimedPose& pose);

}  // namespace apriltrack
