#include "video_bytes.h"

extern "C" {
#include <libavformat/avio.h>
#include <libavutil/error.h>
}

#include <cerrno>
#include <cstdio>

#include "apriltrack/base/error.h"
#include "pipe_input.h"

namespace apriltrack {

VideoBytes::VideoBytes(const std::string& path) : name_(path) {
  if (is_pipe_input(path)) {
    bytes_.emplace<InputPipe>(path);
  } else {
    bytes_.emplace<InputFile>(path);
  }
}

std::size_t VideoBytes::read_on(char* into, std::size_t count) {
  if (const auto* pipe = std::get_if<InputPipe>(&bytes_)) return pipe->read(into, count);
  const std::size_t got =
      std::get<InputFile>(bytes_).read(static_cast<std::uint64_t>(position_), into, count);
  position_ += static_cast<std::int64_t>(got);
  return got;
}

int VideoBytes::read(void* bytes, std::uint8_t* into, int count) try {
  auto& self = *static_cast<VideoBytes*>(bytes);
  const std::size_t got = self.read_on(reinterpret_cast<char*>(into), static_cast<std::size_t>(count));
  return got == 0 ? AVERROR_EOF : static_cast<int>(got);
} catch (const Error&) {
  return AVERROR(EIO);  // no exception may pass through C
}

std::int64_t VideoBytes::seek(void* bytes, std::int64_t offset, int whence) {
  auto& self = *static_cast<VideoBytes*>(bytes);
  const auto size = static_cast<std::int64_t>(std::get<InputFile>(self.bytes_).size());
  if ((whence & AVSEEK_SIZE) != 0) return size;
  const int from = whence & ~AVSEEK_FORCE;
  const std::int64_t base = from == SEEK_CUR ? self.position_ : from == SEEK_END ? size : 0;
  if (offset < -base || offset > INT64_MAX - base) return AVERROR(EINVAL);
  return self.position_ = base + offset;
}

}  // namespace apriltrack
