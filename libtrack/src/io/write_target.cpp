#include "write_target.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "apriltrack/base/error.h"
#include "apriltrack/io/staged_files.h"
#include "descriptor.h"

namespace apriltrack {
namespace fs = std::filesystem;
namespace {

[[noreturn]] void fail_to_follow(const fs::path& path, const std::error_code& error) {
  throw io_error(path.string(), fmt::format("cannot be written: {}", error.message()));
}

/// /dev/stdout, /dev/fd/N and their like name what this process holds open.
bool is_open_descriptor(const fs::path& path) {
  std::error_code error;
  const fs::path folder = fs::canonical(path.parent_path(), error);
  return !error && folder.string().starts_with("/proc/");
}

}  // namespace

bool sync_folder_of(const fs::path& path) {
  const fs::path folder = path.has_parent_path() ? path.parent_path() : ".";
  const Descriptor opened(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (opened.get() < 0) return errno == EACCES;  // who may write there need not be able to list it
  return ::fsync(opened.get()) == 0 || errno == EINVAL || errno == EROFS || errno == ENOTSUP;
}

fs::path follow_links(const fs::path& path) {
  constexpr int kMaxLinks = 40;  // as Linux: path_resolution(7)
  fs::path target = path;
  for (int i = 0; i < kMaxLinks; ++i) {
    std::error_code error;
    if (!fs::is_symlink(fs::symlink_status(target, error))) return target;
    const fs::path next = fs::read_symlink(target, error);
    if (error) fail_to_follow(path, error);
    target = target.parent_path() / next;  // an absolute `next` takes the place of the whole
  }
  fail_to_follow(path, std::make_error_code(std::errc::too_many_symbolic_link_levels));
}

bool is_written_directly(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) return false;
  if (!fs::is_regular_file(status) && !fs::is_directory(status)) return true;
  const bool is_link = fs::is_symlink(fs::symlink_status(path, error));
  return is_open_descriptor(path) ||
         (is_link && is_open_descriptor(path.parent_path() / fs::read_symlink(path, error)));
}

}  // namespace apriltrack
