#pragma once

#include <cstdint>
#include <string>
#include <variant>

#include "apriltrack/io/input_file.h"

namespace apriltrack {

/// The bytes of a video, as FFmpeg wants to read them. Through our own door and not by FFmpeg's protocols, so
/// that a file which names others (a playlist) opens none of them.
class VideoBytes {
 public:
  /// Throws as InputFile does, and InputPipe where it is one.
  explicit VideoBytes(const std::string& path);

  const std::string& name() const { return name_; }
  bool is_pipe() const { return std::holds_alternative<InputPipe>(bytes_); }
  /// FFmpeg's callbacks (libavformat/avio.h, avio_alloc_context); `bytes` is a VideoBytes.
  static int read(void* bytes, std::uint8_t* into, int count);
  /// Not of a pipe.
  static std::int64_t seek(void* bytes, std::int64_t offset, int whence);

 private:
  std::size_t read_on(char* into, std::size_t count);

  std::string name_;
  std::variant<std::monostate, InputFile, InputPipe> bytes_;
  std::int64_t position_ = 0;  ///< Of a file.
};

}  // namespace apriltrack
