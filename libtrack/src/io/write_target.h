#pragma once

#include <filesystem>

namespace apriltrack {

/// The file that a chain of symbolic links names, whether or not it is there yet. Throws Error(kIo) when the
/// chain does not end.
std::filesystem::path follow_links(const std::filesystem::path& path);

/// That a file has this name is on the disk then; false, with errno, where that fails. File systems that
/// cannot wait for a folder are passed over.
bool sync_folder_of(const std::filesystem::path& path);

}  // namespace apriltrack
