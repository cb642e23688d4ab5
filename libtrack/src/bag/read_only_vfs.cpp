#include "read_only_vfs.h"

#include <sqlite3.h>

#include <filesystem>
#include <memory>
#include <string_view>
#include <system_error>

#include "apriltrack/base/error.h"
#include "apriltrack/io/input_file.h"

namespace apriltrack {
namespace {

struct ReadOnlyFile {
  sqlite3_file base;  ///< First, for SQLite hands out a pointer to it.
  InputFile* input;   ///< Owned: SQLite closes what it opened.
  bool has_log;
};

const ReadOnlyFile& of(sqlite3_file* file) {
  return *reinterpret_cast<ReadOnlyFile*>(file);
}

int close_file(sqlite3_file* file) {
  delete of(file).input;
  return SQLITE_OK;
}

int read_file_at(sqlite3_file* file, void* bytes, int count, sqlite3_int64 offset) {
  try {
    const auto wanted = static_cast<std::size_t>(count);
    const std::size_t got =
        of(file).input->read(static_cast<std::uint64_t>(offset), static_cast<char*>(bytes), wanted);
    return got == wanted ? SQLITE_OK : SQLITE_IOERR_READ;
  } catch (const Error&) {
    return SQLITE_IOERR_READ;
  }
}

int size_of_file(sqlite3_file* file, sqlite3_int64* size) {
  *size = static_cast<sqlite3_int64>(of(file).input->size());
  return SQLITE_OK;
}

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
  methods.xDeviceCharacteristics = [](sqlite3_file* file) {
    return of(file).has_log ? 0 : SQLITE_IOCAP_IMMUTABLE;
  };
  return methods;
}

int open_file(sqlite3_vfs*, const char* name, sqlite3_file* file, int flags, int* flags_found) {
  static const sqlite3_io_methods methods = make_methods();
  file->pMethods = nullptr;
  const int kind = flags & (SQLITE_OPEN_MAIN_DB | SQLITE_OPEN_WAL);
  if (!name || kind == 0) return SQLITE_CANTOPEN;
  try {
    auto input = std::make_unique<InputFile>(name);
    auto* const opened = reinterpret_cast<ReadOnlyFile*>(file);
    opened->has_log = kind == SQLITE_OPEN_MAIN_DB && sqlite3_uri_boolean(name, "wal", 0) != 0;
    opened->input = input.release();
    file->pMethods = &methods;
  } catch (const Error&) {
    return SQLITE_CANTOPEN;
  }
  if (flags_found) *flags_found = SQLITE_OPEN_READONLY | kind;
  return SQLITE_OK;
}

sqlite3_vfs make_vfs() {
  sqlite3_vfs vfs = *sqlite3_vfs_find(nullptr);  // clock, random numbers
  vfs.zName = "apriltrack_read_only";
  vfs.szOsFile = sizeof(ReadOnlyFile);
  vfs.mxPathname = 4096;
  vfs.xOpen = open_file;
  vfs.xDelete = [](sqlite3_vfs*, const char*, int) { return SQLITE_READONLY; };
  vfs.xAccess = [](sqlite3_vfs*, const char* name, int, int* is_there) {
    std::error_code ignored;
    *is_there = std::string_view(name).ends_with("-wal") && std::filesystem::exists(name, ignored);
    return SQLITE_OK;
  };
  vfs.xFullPathname = [](sqlite3_vfs*, const char* name, int size, char* full) {
    sqlite3_snprintf(size, full, "%s", name);
    return SQLITE_OK;
  };
  return vfs;
}

}  // namespace

const char* read_only_vfs() {
  static sqlite3_vfs vfs = make_vfs();
  static const bool is_known = sqlite3_vfs_register(&vfs, 0) == SQLITE_OK;
  return is_known ? vfs.zName : nullptr;
}

}  // namespace apriltrack
