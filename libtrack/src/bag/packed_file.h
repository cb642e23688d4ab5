#pragma once

#include <filesystem>
#include <memory>

#include "apriltrack/base/log.h"
#include "apriltrack/io/scratch_file.h"

namespace apriltrack {

/// The contents of a file that zstd packed, in the folder for temporary files. While they are held, or
/// UnpackedBags keeps them, the same file is not unpacked again. Throws Error(kIo) where it is damaged from
/// its beginning, or the disk is full; one that is cut off or damaged later is given as far as it goes, and
/// the log hears of that.
std::shared_ptr<const ScratchFile> unpacked_file(const std::filesystem::path& path, const LogSink& log);

}  // namespace apriltrack
