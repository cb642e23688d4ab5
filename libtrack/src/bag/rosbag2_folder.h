#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "apriltrack/bag/bag_reader.h"

namespace apriltrack {

/// Whether rosbag2 recorded into it: its metadata.yaml says so, or, where there is none, files that end in
/// .db3 or .mcap (or these with .zstd) are there.
bool is_rosbag2_folder(const std::filesystem::path& folder);

/// The files of its recording, in the order of metadata.yaml, or of their names where there is none. Throws
/// Error(kInvalidInput) for a storage or a compression that is not read, Error(kIo) where none is there.
std::vector<std::filesystem::path> rosbag2_files(const std::filesystem::path& folder, const LogSink& log);

}  // namespace apriltrack
