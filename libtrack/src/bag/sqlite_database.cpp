#include "sqlite_database.h"

#include <fmt/format.h>
#include <sqlite3.h>

#include <system_error>
#include <utility>

#include "apriltrack/base/error.h"
#include "apriltrack/io/input_file.h"
#include "read_only_vfs.h"

namespace apriltrack {
namespace {
namespace fs = std::filesystem;

/// Of a path, which may have any bytes.
std::string uri_of(const fs::path& path, bool has_write_ahead_log) {
  std::string uri = "file:";
  for (const char c : path.string()) {
    const bool is_plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                          c == '/' || c == '.' || c == '_' || c == '-';
    uri += is_plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return uri + (has_write_ahead_log ? "?mode=ro&wal=1" : "?mode=ro");
}

/// Logs lie beside the file that a link leads to. What has no name is read as it is.
fs::path real_path(const fs::path& path) {
  if (path.string().starts_with("/proc/self/fd/")) return path;
  std::error_code error;
  const fs::path real = fs::canonical(path, error);
  return error ? fs::absolute(path) : real;
}

/// Empty when it is not there, or cannot be read; then `reason` says why.
std::string first_byte(const fs::path& path, std::string& reason) {
  std::error_code ignored;
  if (!fs::exists(path, ignored)) return "";
  try {
    const InputFile file(path);
    std::string byte(1, '\0');
    byte.resize(file.read(0, byte.data(), 1));
    return byte;
  } catch (const Error& error) {
    reason = error.cause();
    return "";
  }
}

SqliteLog find_log(const fs::path& path) {
  const fs::path ahead = path.string() + "-wal", rollback = path.string() + "-journal";
  std::string reason;
  if (!first_byte(ahead, reason).empty()) return {SqliteLog::Kind::kReadAhead, ahead.filename(), ""};
  if (!reason.empty()) return {SqliteLog::Kind::kUnreadAhead, ahead.filename(), reason};
  // One that begins with zero is of a transaction that ended (sqlite.org/fileformat2.html, section 3).
  const std::string start = first_byte(rollback, reason);
  if ((start.empty() && reason.empty()) || start == std::string(1, '\0')) return {};
  return {SqliteLog::Kind::kRollback, rollback.filename(), reason};
}

}  // namespace

void SqliteDatabase::Closer::operator()(sqlite3* database) const {
  sqlite3_close(database);
}
void SqliteDatabase::Statement::Finalizer::operator()(sqlite3_stmt* statement) const {
  sqlite3_finalize(statement);
}

SqliteDatabase::SqliteDatabase(const fs::path& path, std::string name) : name_(std::move(name)) {
  const fs::path real = real_path(path);
  log_ = find_log(real);
  const bool reads_log = log_.kind == SqliteLog::Kind::kReadAhead;
  sqlite3* raw = nullptr;
  const int status =
      sqlite3_open_v2(uri_of(real, reads_log).c_str(), &raw,
                      SQLITE_OPEN_READONLY | SQLITE_OPEN_URI | SQLITE_OPEN_NOMUTEX, read_only_vfs());
  database_.reset(raw);
  if (status != SQLITE_OK) throw io_error(name_, fmt::format("cannot be opened: {}", last_error()));
  sqlite3_exec(raw, "PRAGMA locking_mode = EXCLUSIVE", nullptr, nullptr, nullptr);  // of this process alone
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
