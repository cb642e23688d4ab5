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
#include "nameless_file.h"
#include "write_target.h"

namespace apriltrack {
namespace fs = std::filesystem;
namespace {

/// What is written beside a file to take its place: without a name until it is complete, where the file
/// system can, so that nothing is left of it however the program ends; else by a name that is taken away on
/// every way out, but for the one on which it takes its place.
class AsideFile {
 public:
  explicit AsideFile(fs::path path) : path_(std::move(path)), file_(open_nameless_file(path_.parent_path())) {
    has_name_ = file_.get() < 0;
    if (has_name_) file_ = Descriptor(::open(path_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644));
  }
  AsideFile(const AsideFile&) = delete;
  AsideFile& operator=(const AsideFile&) = delete;
  ~AsideFile() {
    if (has_name_) ::unlink(path_.c_str());
  }
  int descriptor() const { return file_.get(); }
  /// Of a complete file. A name that an ended process of the same number left is in the way.
  bool replace(const fs::path& target) {
    if (!has_name_) ::unlink(path_.c_str());
    has_name_ = has_name_ || give_name(file_.get(), path_);
    if (!has_name_ || !file_.close() || ::rename(path_.c_str(), target.c_str()) != 0) return false;
    has_name_ = false;
    return true;
  }

 private:
  fs::path path_;
  Descriptor file_;
  bool has_name_ = false;
};

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
  const int file = aside.descriptor();
  if (file < 0) fail_to_write(path, errno);
  const bool is_complete =
      (!existing || ::fchmod(file, existing->st_mode & 07777) == 0) && write_pieces(file, writer) &&
      (durability == Durability::kComplete || ::fsync(file) == 0) && aside.replace(path) &&
      (durability == Durability::kComplete || sync_folder_of(path));
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
