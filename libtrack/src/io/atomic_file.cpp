#include "apriltrack/io/atomic_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

#include "apriltrack/base/error.h"
#include "apriltrack/io/staged_files.h"
#include "descriptor.h"
#include "write_target.h"

namespace apriltrack {
namespace fs = std::filesystem;
namespace {

/// A file that is taken away on every way out, but for the one on which it has got its name.
class AsideFile {
 public:
  explicit AsideFile(fs::path path) : path_(std::move(path)) {}
  AsideFile(const AsideFile&) = delete;
  AsideFile& operator=(const AsideFile&) = delete;
  ~AsideFile() {
    if (!path_.empty()) ::unlink(path_.c_str());
  }
  const fs::path& path() const { return path_; }
  bool rename_to(const fs::path& path) {
    if (::rename(path_.c_str(), path.c_str()) != 0) return false;
    path_.clear();
    return true;
  }

 private:
  fs::path path_;
};

bool write_all(int fd, std::string_view contents) {
  while (!contents.empty()) {
    const ssize_t written = ::write(fd, contents.data(), contents.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return false;
    contents.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

[[noreturn]] void fail_to_write(const fs::path& path, int code, std::string_view kept = "") {
  throw io_error(path.string(), fmt::format("cannot be written: {}{}", system_reason(code), kept));
}

/// False where a piece cannot be written; no more are then. What `writer` throws goes through.
bool write_pieces(int fd, const PieceWriter& writer) {
  int code = 0;
  writer([&](std::string_view piece) {
    if (code == 0 && !write_all(fd, piece)) code = errno;
  });
  errno = code;
  return code == 0;
}

/// Appends, because standard output may be a file that holds something already.
void write_directly(const fs::path& path, const PieceWriter& writer) {
  Descriptor file(::open(path.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC));
  if (file.get() < 0 || !write_pieces(file.get(), writer) || !file.close()) fail_to_write(path, errno);
}

void write_beside_and_rename(const fs::path& path, const PieceWriter& writer, const struct stat* existing,
                             Durability durability) {
  fs::path beside = path;
  beside += fmt::format(".{}.part", ::getpid());
  AsideFile aside(beside);
  Descriptor file(::open(aside.path().c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644));
  if (file.get() < 0) fail_to_write(path, errno);
  const bool is_complete = (!existing || ::fchmod(file.get(), existing->st_mode & 07777) == 0) &&
                           write_pieces(file.get(), writer) &&
                           (durability == Durability::kComplete || ::fsync(file.get()) == 0) &&
                           file.close() && aside.rename_to(path);
  if (!is_complete) fail_to_write(path, errno, existing ? "; the existing file was kept" : "");
}

}  // namespace

void write_file_atomically(const fs::path& path, std::string_view contents, Durability durability) {
  write_pieces_atomically(
      path, [&](const auto& write) { write(contents); }, durability);
}

void write_pieces_atomically(const fs::path& path, const PieceWriter& writer, Durability durability) {
  struct stat existing {};
  const bool exists = ::stat(path.c_str(), &existing) == 0;
  if (is_written_directly(path)) return write_directly(path, writer);
  write_beside_and_rename(follow_links(path), writer, exists ? &existing : nullptr, durability);
}

}  // namespace apriltrack
