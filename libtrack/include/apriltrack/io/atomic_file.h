#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

#include "apriltrack/io/input_file.h"

namespace apriltrack {

/// What is certain when write_file_atomically returns.
enum class Durability {
  kOnDisk,    ///< The file outlives a loss of power: the write waits for the disk.
  kComplete,  ///< The file is complete for every program that reads it; for files by the hundred.
};

/// Writes beside the target and renames when all is written, so that an existing file is either kept or
/// replaced by a complete one with the same mode. A symbolic link stays, and the file that it names is
/// replaced. What is no regular file (a device, a FIFO, /dev/stdout) is written to directly. Throws
/// Error(kIo) with the path and the system's reason (full disk, no permission, no folder).
void write_file_atomically(const std::filesystem::path& path, std::string_view contents,
                           Durability durability = Durability::kOnDisk);

/// The same of contents too large to be kept in memory: `writer` hands them over piece by piece.
using PieceWriter = std::function<void(const std::function<void(std::string_view piece)>& write)>;
void write_pieces_atomically(const std::filesystem::path& path, const PieceWriter& writer,
                             Durability durability = Durability::kOnDisk);

}  // namespace apriltrack
