#include "video_bytes.h"

extern "C" {
#include <libavformat/avio.h>
#include <libavutil/error.h>
}

#include <cerrno>
#include <cstdio>

#include "apriltrack/base/error.h"

namespace apriltrack {

int VideoBytes::read(void* bytes, std::uint8_t* into, int count) try {
  auto& self = *static_cast<VideoBytes*>(bytes);
  const std::size_t got = self.file_.read(static_cast<std::uint64_t>(self.position_),
                                          reinterpret_cast<char*>(into), static_cast<std::size_t>(count));
  self.position_ += static_cast<std::int64_t>(got);
  return got == 0 ? AVERROR_EOF : static_cast<int>(got);
} catch (const Error&) {
  return AVERROR(EIO);  // no exception may pass through C
}

std::int64_t VideoBytes::seek(void* bytes, std::int64_t offset, int whence) {
  auto& self = *static_cast<VideoBytes*>(bytes);
  const auto size = static_cast<std::int64_t>(self.file_.size());
  if ((whence & AVSEEK_SIZE) != 0) return size;
  const int from = whence & ~AVSEEK_FORCE;
  const std::int64_t base = from == SEEK_CUR ? self.position_ : from == SEEK_END ? size : 0;
  if (offset < -base || offset > INT64_MAX - base) return AVERROR(EINVAL);
  return self.position_ = base + offset;
}

}  // namespace apriltrack
