#pragma once

#include <filesystem>

namespace apriltrack {

/// Whether the path is of what this process holds open, /proc/self/fd/N: it may have no name any more, and
/// SQLite, which looks for the name that a link leads to, cannot open it by itself.
bool is_open_descriptor(const std::filesystem::path& path);

/// The name of a VFS of SQLite (sqlite.org/vfs.html) that reads such paths, and nothing else; made known on
/// first use. A read beyond the end is an error there, as for all databases here.
const char* descriptor_vfs();

}  // namespace apriltrack
