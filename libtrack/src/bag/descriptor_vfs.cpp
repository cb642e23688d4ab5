#include "descriptor_vfs.h"

#include <fcntl.h>
#include <sqlite3.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <string_view>

namespace apriltrack {
namespace {

constexpr std::string_view kFolder = "/proc/self/fd/";

struct DescriptorFile {
  sqlite3_file base;  ///< First, for SQLite hands out a pointer to it.
  int descriptor;
};

int descriptor_of(sqlite3_file* file) {
  return reinterpret_cast<DescriptorFile*>(file)->descriptor;
}

int close_file(sqlite3_file* file) {
  ::close(descriptor_of(file));
  return SQLITE_OK;
}

int read_file_at(sqlite3_file* file, void* bytes, int count, sqlite3_int64 offset) {
  int done = 0;
  while (done < count) {
    const ssize_t got = ::pread(descriptor_of(file), static_cast<char*>(bytes) + done,
                                static_cast<std::size_t>(count - done), static_cast<off_t>(offset + done));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return SQLITE_IOERR_READ;
    done += static_cast<int>(got);
  }
  return SQLITE_OK;
}

int size_of_file(sqlite3_file* file, sqlite3_int64* size) {
  struct stat found {};
  if (::fstat(descriptor_of(file), &found) != 0) return SQLITE_IOERR_FSTAT;
  *size = found.st_size;
  return SQLITE_OK;
}

/// For reading alone, and by this process alone.
sqlite3_io_methods make_methods() {
  sqlite3_io_methods methods{};
  methods.iVersion = 1;
  methods.xClose = close_file;
  methods.xRead = read_file_at;
  methods.xWrite = [](sqlite3_file*, const void*, int, sqlite3_int64) { return SQLITE_READONLY; };
  methods.xTruncate = [](sqlite3_file*, sqlite3_int64) { return SQLITE_READONLY; };
  methods.xSync = [](sqlite3_file*, int) { return SQLITE_OK; };
  methods.xFileSize = size_of_file;
  methods.xLock = [](sqlite3_file*, int) { return SQLITE_OK; };
  methods.xUnlock = [](sqlite3_file*, int) { return SQLITE_OK; };
  methods.xCheckReservedLock = [](sqlite3_file*, int* is_reserved) {
    *is_reserved = 0;
    return SQLITE_OK;
  };
  methods.xFileControl = [](sqlite3_file*, int, void*) { return SQLITE_NOTFOUND; };
  methods.xSectorSize = [](sqlite3_file*) { return 4096; };
  methods.xDeviceCharacteristics = [](sqlite3_file*) { return SQLITE_IOCAP_IMMUTABLE; };
  return methods;
}

int open_file(sqlite3_vfs*, const char* name, sqlite3_file* file, int flags, int* flags_found) {
  static const sqlite3_io_methods methods = make_methods();
  file->pMethods = nullptr;
  const std::string_view path = name ? name : "";
  if (!path.starts_with(kFolder) || (flags & SQLITE_OPEN_MAIN_DB) == 0) return SQLITE_CANTOPEN;
  int number = -1;
  std::from_chars(path.data() + kFolder.size(), path.data() + path.size(), number);
  const int descriptor = ::fcntl(number, F_DUPFD_CLOEXEC, 0);
  if (descriptor < 0) return SQLITE_CANTOPEN;
  reinterpret_cast<DescriptorFile*>(file)->descriptor = descriptor;
  file->pMethods = &methods;
  if (flags_found) *flags_found = SQLITE_OPEN_READONLY | SQLITE_OPEN_MAIN_DB;
  return SQLITE_OK;
}

sqlite3_vfs make_vfs() {
  sqlite3_vfs vfs = *sqlite3_vfs_find(nullptr);  // clock, random numbers
  vfs.zName = "apriltrack_descriptors";
  vfs.szOsFile = sizeof(DescriptorFile);
  vfs.xOpen = open_file;
  vfs.xDelete = [](sqlite3_vfs*, const char*, int) { return SQLITE_READONLY; };
  vfs.xAccess = [](sqlite3_vfs*, const char*, int, int* is_there) {
    *is_there = 0;  // no journals
    return SQLITE_OK;
  };
  vfs.xFullPathname = [](sqlite3_vfs*, const char* name, int size, char* full) {
    sqlite3_snprintf(size, full, "%s", name);
    return SQLITE_OK;
  };
  return vfs;
}

}  // namespace

bool is_open_descriptor(const std::filesystem::path& path) {
  return path.string().starts_with(kFolder);
}

const char* descriptor_vfs() {
  static sqlite3_vfs vfs = make_vfs();
  static const bool is_known = sqlite3_vfs_register(&vfs, 0) == SQLITE_OK;
  return is_known ? vfs.zName : nullptr;
}

}  // namespace apriltrack
