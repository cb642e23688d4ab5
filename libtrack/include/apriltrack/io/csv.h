#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace apriltrack {

/// A table with a header line; columns are found by name. Comma-separated, no quoting, LF or CRLF, `#` before
/// the header's first name is passed over (as EuRoC writes it), blank lines are passed over.
class CsvTable {
 public:
  /// Throws Error(kIo) when the file cannot be read; Error(kInvalidInput) with file and line when a row has
  /// more or fewer fields than the header, or a required column is missing (the message lists those there
  /// are).
  static CsvTable read_file(const std::filesystem::path& path,
                            const std::vector<std::string>& required_columns);
  /// The same of a text, which the table keeps; name: what messages call it.
  static CsvTable read_text(std::string text, const std::string& name,
                            const std::vector<std::string>& required_columns);

  std::size_t num_rows() const { return lines_.size(); }
  /// Names, in the file's order.
  const std::vector<std::string>& columns() const { return header_; }
  bool has_column(std::string_view name) const { return column(name).has_value(); }

  /// The field as it stands, without blanks around it. Requires that the column exists.
  std::string_view text(std::size_t row, std::string_view column) const;
  bool is_empty(std::size_t row, std::string_view column) const { return text(row, column).empty(); }
  /// Throws Error(kInvalidInput) with file, line, column and value unless the field is a finite number.
  double number(std::size_t row, std::string_view column) const;
  long long integer(std::size_t row, std::string_view column) const;

  /// "detections.csv:17".
  std::string where(std::size_t row) const;

 private:
  /// Where a field is in the text: tables have tens of millions of them.
  struct Field {
    std::uint32_t begin = 0;
    std::uint32_t size = 0;
  };
  std::optional<std::size_t> column(std::string_view name) const;
  void add_row(std::size_t line_number, std::string_view line);

  std::string name_;
  std::string text_;
  std::vector<std::string> header_;
  std::vector<Field> fields_;       ///< Row by row, each as long as the header.
  std::vector<std::size_t> lines_;  ///< Number of each row's line.
};

}  // namespace apriltrack
