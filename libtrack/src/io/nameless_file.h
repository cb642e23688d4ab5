#pragma once

#include <filesystem>

#include "descriptor.h"

namespace apriltrack {

/// A new file in a folder, open to be read and written, that has no name (open(2), O_TMPFILE): nothing is
/// left of it, however the program ends. -1 where the file system or the kernel has no such files, or nothing
/// can be made there.
Descriptor open_nameless_file(const std::filesystem::path& folder);

/// The path by which this process reaches what it holds open.
std::filesystem::path path_of(int descriptor);

/// Gives a nameless file its name, which must be free; false, with errno, where that fails.
bool give_name(int descriptor, const std::filesystem::path& path);

}  // namespace apriltrack
