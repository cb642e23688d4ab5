#pragma once

#include <filesystem>
#include <memory>

#include "apriltrack/base/log.h"
#include "apriltrack/io/scratch_file.h"

namespace apriltrack {

/// The contents of a file that zstd packed, in the folder for temporary files. What a process unpacked it
/// keeps until its end: commands open their input several times. Throws Error(kIo) where it is damaged from
/// its beginning, or the disk is full; one that is cut off or damaged later is given as far as it goes, and
/// the log hears of that.
std::shared_ptr<const ScratchFile> unpacked_file(const std::filesystem::path& path, const LogSink& log);

}  // namespace apriltrack
