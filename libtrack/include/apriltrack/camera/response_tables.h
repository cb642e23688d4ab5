#pragma once

#include <filesystem>
#include <vector>

#include "apriltrack/camera/camera.h"

namespace apriltrack {

class StagedFiles;

/// The files that a camera file names as its `response`, so that a program does not write over them. Throws
/// Error(kIo), Error(kInvalidInput) where the camera file is no YAML or JSON; what else is wrong with it,
/// read_cameras tells.
std::vector<std::filesystem::path> response_tables(const std::filesystem::path& camera_file);

/// The files that write_cameras() writes beside `camera_file`: one for each camera whose response is a table.
std::vector<std::filesystem::path> response_tables_to_write(const std::filesystem::path& camera_file,
                                                            const CameraRig& rig);

/// write_cameras(), put in place with all else that `files` hold, when they are committed.
void write_cameras(StagedFiles& files, const std::filesystem::path& path, const CameraRig& rig);

}  // namespace apriltrack
