#pragma once

#include <cstdint>
#include <string>

#include "apriltrack/io/input_file.h"

namespace apriltrack {

/// The bytes of a video file, as FFmpeg wants to read them. Through our own door and not by FFmpeg's
/// protocols, so that a file which names others (a playlist) opens none of them.
class VideoBytes {
 public:
  /// Throws as InputFile does.
  explicit VideoBytes(const std::string& path) : file_(path) {}

  const std::string& name() const { return file_.name(); }
  /// FFmpeg's callbacks (libavformat/avio.h, avio_alloc_context); `bytes` is a VideoBytes.
  static int read(void* bytes, std::uint8_t* into, int count);
  static std::int64_t seek(void* bytes, std::int64_t offset, int whence);

 private:
  InputFile file_;
  std::int64_t position_ = 0;
};

}  // namespace apriltrack
