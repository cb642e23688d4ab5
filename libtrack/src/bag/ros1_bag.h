#pragma once

#include <memory>

#include "chunk_layout.h"
#include "random_access_file.h"

namespace apriltrack {

inline constexpr std::string_view kRos1Magic = "#ROSBAG V";

/// A ROS 1 bag of version 2.0. Throws Error(kInvalidInput) for another version, and one that is encrypted.
std::unique_ptr<ChunkedFormat> ros1_bag(std::shared_ptr<const RandomAccessFile> file);

}  // namespace apriltrack
