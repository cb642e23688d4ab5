#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

struct sqlite3;
struct sqlite3_stmt;

namespace apriltrack {

/// A SQLite file, to be read only.
class SqliteDatabase {
 public:
  /// Nothing is written beside it, unless a recorder left a log there that must be read as well. Throws
  /// Error(kIo). name: what messages call it.
  SqliteDatabase(const std::filesystem::path& path, std::string name);

  const std::string& name() const { return name_; }
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
  std::unique_ptr<sqlite3, Closer> database_;
};

}  // namespace apriltrack
