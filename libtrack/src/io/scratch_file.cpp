#include "apriltrack/io/scratch_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <string>

#include "apriltrack/base/error.h"
#include "nameless_file.h"

namespace apriltrack {

ScratchFile::ScratchFile(const std::filesystem::path& place) {
  Descriptor nameless = open_nameless_file(place.parent_path());
  if (nameless.get() >= 0) {
    path_ = path_of(nameless.get());
    descriptor_ = nameless.release();
    return;
  }
  std::string name = fmt::format("{}.{}.XXXXXX", place.string(), ::getpid());
  descriptor_ = ::mkostemp(name.data(), O_CLOEXEC);
  if (descriptor_ < 0)
    throw io_error(place.string(), fmt::format("cannot be written: {}", system_reason(errno)));
  path_ = name;
  has_name_ = true;
}

ScratchFile::~ScratchFile() {
  ::close(descriptor_);
  if (has_name_) ::unlink(path_.c_str());
}

}  // namespace apriltrack
