#pragma once

#include <filesystem>

namespace apriltrack {

/// The file that a chain of symbolic links names, whether or not it is there yet. Throws Error(kIo) when the
/// chain does not end.
std::filesystem::path follow_links(const std::filesystem::path& path);

/// What nothing can be written beside, to take its place: a device, a FIFO, /dev/stdout, /dev/fd/N.
bool is_written_directly(const std::filesystem::path& path);

}  // namespace apriltrack
