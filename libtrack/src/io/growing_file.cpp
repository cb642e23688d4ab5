#include "apriltrack/io/growing_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <utility>

#include "apriltrack/base/error.h"
#include "apriltrack/io/staged_files.h"

namespace apriltrack {

GrowingFile::GrowingFile(StagedFiles& files, const std::filesystem::path& path) : name_(path.string()) {
  // Standard output may be a file that holds something already.
  const int how = is_written_directly(path) ? O_APPEND : O_CREAT | O_TRUNC;
  descriptor_ = ::open(files.stage(path).c_str(), O_WRONLY | O_CLOEXEC | how, 0644);
  if (descriptor_ < 0) fail();
}

GrowingFile::~GrowingFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void GrowingFile::write(std::string_view bytes) {
  size_ += bytes.size();
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail();
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
}

void GrowingFile::close() {
  // A pipe has no disk.
  if (::fsync(descriptor_) != 0 && errno != EINVAL && errno != EROFS) fail();
  if (::close(std::exchange(descriptor_, -1)) != 0) fail();
}

void GrowingFile::fail() const {
  throw io_error(name_, fmt::format("cannot be written: {}", std::generic_category().message(errno)));
}

}  // namespace apriltrack
