#include "sqlite_database.h"

#include <fmt/format.h>
#include <sqlite3.h>

#include <system_error>
#include <utility>

#include "apriltrack/base/error.h"
#include "descriptor_vfs.h"

namespace apriltrack {
namespace {
namespace fs = std::filesystem;

/// Of a path, which may have any bytes.
std::string uri_of(const fs::path& path, bool is_immutable) {
  std::string uri = "file:";
  for (const char c : fs::absolute(path).string()) {
    const bool is_plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                          c == '/' || c == '.' || c == '_' || c == '-';
    uri += is_plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return uri + (is_immutable ? "?mode=ro&immutable=1" : "?mode=ro");
}

/// Of a recorder that did not close it: what the file itself does not have yet.
bool has_log(const fs::path& path) {
  std::error_code ignored;
  return fs::exists(path.string() + "-wal", ignored) || fs::exists(path.string() + "-journal", ignored);
}

/// SQLite takes what a cut file lacks of its last page for zeros, and so hands out messages that end in
/// zeros. Here they are an error.
void refuse_short_reads(sqlite3* database) {
  using Read = int (*)(sqlite3_file*, void*, int, sqlite3_int64);
  static Read read_of_system = nullptr;
  static sqlite3_io_methods strict;
  sqlite3_file* file = nullptr;
  if (sqlite3_file_control(database, "main", SQLITE_FCNTL_FILE_POINTER, &file) != SQLITE_OK || !file ||
      !file->pMethods)
    return;
  static const bool is_made = [&] {
    strict = *file->pMethods;
    read_of_system = strict.xRead;
    strict.xRead = [](sqlite3_file* of, void* bytes, int count, sqlite3_int64 offset) {
      const int status = read_of_system(of, bytes, count, offset);
      return status == SQLITE_IOERR_SHORT_READ ? SQLITE_IOERR_READ : status;
    };
    return true;
  }();
  if (is_made && file->pMethods->xClose == strict.xClose) file->pMethods = &strict;
}

}  // namespace

void SqliteDatabase::Closer::operator()(sqlite3* database) const {
  sqlite3_close(database);
}
void SqliteDatabase::Statement::Finalizer::operator()(sqlite3_stmt* statement) const {
  sqlite3_finalize(statement);
}

SqliteDatabase::SqliteDatabase(const fs::path& path, std::string name) : name_(std::move(name)) {
  const bool is_descriptor = is_open_descriptor(path);
  sqlite3* raw = nullptr;
  const int status = sqlite3_open_v2(uri_of(path, !has_log(path)).c_str(), &raw,
                                     SQLITE_OPEN_READONLY | SQLITE_OPEN_URI | SQLITE_OPEN_NOMUTEX,
                                     is_descriptor ? descriptor_vfs() : nullptr);
  database_.reset(raw);
  if (status != SQLITE_OK) throw io_error(name_, fmt::format("cannot be opened: {}", last_error()));
  if (!is_descriptor) refuse_short_reads(raw);
  // Else a file that is shorter than its header says is refused whole; it is open for reading only.
  sqlite3_db_config(raw, SQLITE_DBCONFIG_WRITABLE_SCHEMA, 1, nullptr);
  // A damaged file may hold views and triggers of anyone's making.
  sqlite3_db_config(raw, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
}

std::string SqliteDatabase::last_error() const {
  return database_ ? sqlite3_errmsg(database_.get()) : "no memory";
}

bool SqliteDatabase::has_column(const std::string& table, const std::string& column) const {
  return sqlite3_table_column_metadata(database_.get(), nullptr, table.c_str(), column.c_str(), nullptr,
                                       nullptr, nullptr, nullptr, nullptr) == SQLITE_OK;
}

SqliteDatabase::Statement::Statement(const SqliteDatabase& database, const std::string& sql)
    : database_(database.database_.get()) {
  sqlite3_stmt* raw = nullptr;
  const int status = sqlite3_prepare_v2(database_, sql.c_str(), static_cast<int>(sql.size()), &raw, nullptr);
  statement_.reset(raw);
  if (status != SQLITE_OK)
    throw io_error(database.name(), fmt::format("cannot be read: {}", database.last_error()));
}

SqliteDatabase::Statement::Step SqliteDatabase::Statement::step() {
  const int status = sqlite3_step(statement_.get());
  if (status == SQLITE_ROW) return Step::kRow;
  return status == SQLITE_DONE ? Step::kDone : Step::kDamaged;
}

void SqliteDatabase::Statement::bind(std::int64_t value) {
  sqlite3_reset(statement_.get());
  sqlite3_bind_int64(statement_.get(), 1, value);
}

std::int64_t SqliteDatabase::Statement::integer(int column) const {
  return sqlite3_column_int64(statement_.get(), column);
}

std::string SqliteDatabase::Statement::text(int column) const {
  const unsigned char* text = sqlite3_column_text(statement_.get(), column);
  return text ? reinterpret_cast<const char*>(text) : "";
}

std::string_view SqliteDatabase::Statement::blob(int column) const {
  const void* bytes = sqlite3_column_blob(statement_.get(), column);
  const int size = sqlite3_column_bytes(statement_.get(), column);
  if (!bytes || size <= 0) return {};
  return {static_cast<const char*>(bytes), static_cast<std::size_t>(size)};
}

bool SqliteDatabase::Statement::has_failed() const {
  const int code = sqlite3_errcode(database_);
  return code != SQLITE_ROW && code != SQLITE_OK && code != SQLITE_DONE;
}

}  // namespace apriltrack
