#include "nameless_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

namespace apriltrack {
namespace fs = std::filesystem;

Descriptor open_nameless_file(const fs::path& folder) {
  constexpr int kMode = 0644;
  const fs::path where = folder.empty() ? fs::path(".") : folder;
  Descriptor file(::open(where.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, kMode));
  // Where /proc is missing, it could never be reached again.
  if (file.get() >= 0 && ::access(path_of(file.get()).c_str(), F_OK) != 0) return Descriptor(-1);
  return file;
}

fs::path path_of(int descriptor) {
  return fmt::format("/proc/self/fd/{}", descriptor);
}

bool give_name(int descriptor, const fs::path& path) {
  return ::linkat(AT_FDCWD, path_of(descriptor).c_str(), AT_FDCWD, path.c_str(), AT_SYMLINK_FOLLOW) == 0;
}

}  // namespace apriltrack
