#pragma once

#include <filesystem>
#include <memory>

#include "apriltrack/base/log.h"

namespace apriltrack {

/// A new file in the folder for temporary files, which it takes away in the end.
class TemporaryFile {
 public:
  /// Throws Error(kIo) where none can be made.
  TemporaryFile();
  ~TemporaryFile();
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  const std::filesystem::path& path() const { return path_; }
  int descriptor() const { return descriptor_; }

 private:
  std::filesystem::path path_;
  int descriptor_ = -1;
};

/// The contents of a file that zstd packed, in the folder for temporary files. What a process unpacked it
/// keeps until its end: commands open their input several times. Throws Error(kIo) where it is damaged from
/// its beginning, or the disk is full; one that is cut off or damaged later is given as far as it goes, and
/// the log hears of that.
std::shared_ptr<const TemporaryFile> unpacked_file(const std::filesystem::path& path, const LogSink& log);

}  // namespace apriltrack
