#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

struct sqlite3;
struct sqlite3_stmt;

namespace apriltrack {

/// What a recorder that did not end leaves beside its file.
struct SqliteLog {
  enum class Kind {
    kNone,
    kReadAhead,    ///< A write-ahead log: it is read with the file.
    kUnreadAhead,  ///< One that cannot be read: what is in it is missing.
    kRollback,     ///< The file has parts of a transaction that was not finished; this is how to undo it.
  };
  Kind kind = Kind::kNone;
  std::string name;    ///< Of the log's file.
  std::string reason;  ///< Why it is not read.
};

/// A SQLite file, to be read only. Nothing is ever written to it or beside it. It is read as it is found: a
/// transaction that was not finished is not undone, for what is there of it is the end of the recording.
class SqliteDatabase {
 public:
  /// Throws Error(kIo). name: what messages call it.
  SqliteDatabase(const std::filesystem::path& path, std::string name);

  const std::string& name() const { return name_; }
  const SqliteLog& log() const { return log_; }
  std::string last_error() const;
  bool has_column(const std::string& table, const std::string& column) const;

  /// One prepared statement.
  class Statement {
   public:
    /// Throws Error(kIo) that tells SQLite's words.
    Statement(const SqliteDatabase& database, const std::string& sql);

    enum class Step { kRow, kDone, kDamaged };
    /// kDamaged: the file is not as it must be, or cannot be read, there.
    Step step();
    void bind(std::int64_t value);
    std::int64_t integer(int column) const;
    std::string text(int column) const;
    /// Valid until the next step; bytes are held by the statement.
    std::string_view blob(int column) const;
    /// A column with many bytes was not read whole.
    bool has_failed() const;

   private:
    struct Finalizer {
      void operator()(sqlite3_stmt* statement) const;
    };
    sqlite3* database_;
    std::unique_ptr<sqlite3_stmt, Finalizer> statement_;
  };

 private:
  struct Closer {
    void operator()(sqlite3* database) const;
  };
  std::string name_;
  SqliteLog log_;
  std::unique_ptr<sqlite3, Closer> database_;
};

}  // namespace apriltrack
