#include "apriltrack/io/growing_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <utility>

#include "apriltrack/base/error.h"
#include "apriltrack/io/staged_files.h"
#include "descriptor.h"
#include "nameless_file.h"

namespace apriltrack {

GrowingFile::GrowingFile(StagedFiles& files, const std::filesystem::path& path)
    : name_(path.string()), place_(files.stage(path)) {
  // Standard output may be a file that holds something already.
  if (is_written_directly(path)) {
    descriptor_ = ::open(place_.c_str(), O_WRONLY | O_CLOEXEC | O_APPEND);
  } else {
    descriptor_ = open_nameless_file(place_.parent_path()).release();
    is_nameless_ = descriptor_ >= 0;
    if (!is_nameless_) descriptor_ = ::open(place_.c_str(), O_WRONLY | O_CLOEXEC | O_CREAT | O_TRUNC, 0644);
  }
  if (descriptor_ < 0) fail();
}

GrowingFile::~GrowingFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void GrowingFile::write(std::string_view bytes) {
  size_ += bytes.size();
  if (!write_all(descriptor_, bytes)) fail();
}

void GrowingFile::close() {
  // A pipe has no disk.
  if (::fsync(descriptor_) != 0 && errno != EINVAL && errno != EROFS) fail();
  if (is_nameless_) {
    ::unlink(place_.c_str());  // which an ended process of the same number may have left
    if (!give_name(descriptor_, place_)) fail();
  }
  if (::close(std::exchange(descriptor_, -1)) != 0) fail();
}

void GrowingFile::fail() const {
  throw io_error(name_, fmt::format("cannot be written: {}", std::generic_category().message(errno)));
}

}  // namespace apriltrack
