#include "random_access_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>
#include <utility>

#include "apriltrack/base/error.h"

namespace apriltrack {
namespace {

Error told_by_system(const std::string& name, int code) {
  return io_error(name, fmt::format("cannot be read: {}", std::generic_category().message(code)));
}

}  // namespace

RandomAccessFile::RandomAccessFile(const std::filesystem::path& path, std::string name)
    : name_(std::move(name)) {
  descriptor_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor_ < 0) throw told_by_system(name_, errno);
  struct stat found {};
  const bool is_told = ::fstat(descriptor_, &found) == 0;
  if (is_told && S_ISREG(found.st_mode)) {
    size_ = static_cast<std::uint64_t>(found.st_size);
    return;
  }
  const int code = errno;
  ::close(descriptor_);
  if (!is_told) throw told_by_system(name_, code);
  throw io_error(name_, "is no regular file: a bag is read here and there");
}

RandomAccessFile::~RandomAccessFile() {
  ::close(descriptor_);
}

void RandomAccessFile::read(std::uint64_t offset, std::uint64_t count, ByteBuffer& into) const {
  into.set_size(0);
  if (offset >= size_) return;
  const auto wanted = static_cast<std::size_t>(std::min(count, size_ - offset));
  into.reserve(wanted);
  std::size_t done = 0;
  while (done < wanted) {
    const ssize_t got =
        ::pread(descriptor_, into.data() + done, wanted - done, static_cast<off_t>(offset + done));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw told_by_system(name_, errno);
    if (got == 0) break;
    done += static_cast<std::size_t>(got);
  }
  into.set_size(done);
}

std::string RandomAccessFile::read(std::uint64_t offset, std::uint64_t count) const {
  ByteBuffer buffer;
  read(offset, count, buffer);
  return std::string(buffer.view());
}

}  // namespace apriltrack
