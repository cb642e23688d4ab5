#pragma once

#include <filesystem>
#include <vector>

namespace apriltrack {

/// The files that a camera file names as its `response`, so that a program does not write over them. Throws
/// Error(kIo), Error(kInvalidInput) where the camera file is no YAML or JSON; what else is wrong with it,
/// read_cameras tells.
std::vector<std::filesystem::path> response_tables(const std::filesystem::path& camera_file);

}  // namespace apriltrack
