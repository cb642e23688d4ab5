#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace apriltrack {

/// Writes beside the target and renames when all is on the disk, so that an existing file is either kept or
/// replaced by a complete one. Throws Error(kIo) with the path and the system's reason (full disk, no
/// permission, no folder).
void write_file_atomically(const std::filesystem::path& path, std::string_view contents);

/// Throws Error(kIo) with the path and the system's reason.
std::string read_file(const std::filesystem::path& path);

}  // namespace apriltrack
