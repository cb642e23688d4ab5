#include "apriltrack/io/csv.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "apriltrack/base/check.h"
#include "apriltrack/base/error.h"
#include "apriltrack/io/numbers.h"
#include "apriltrack/io/text_file.h"
#include "apriltrack/io/trimmed.h"

namespace apriltrack {
namespace {

/// Passes each without the blanks around it.
template <class Function>
void for_each_field(std::string_view line, const Function& function) {
  for (;;) {
    const std::size_t comma = line.find(',');
    function(trimmed(line.substr(0, comma)));
    if (comma == std::string_view::npos) return;
    line.remove_prefix(comma + 1);
  }
}

std::vector<std::string> split_header(std::string_view line) {
  line = trimmed(line);
  if (line.starts_with('#')) line.remove_prefix(1);
  std::vector<std::string> names;
  for_each_field(line, [&](std::string_view name) { names.emplace_back(name); });
  return names;
}

/// Passes the lines that are not blank, with their numbers from 1.
template <class Function>
void for_each_line(std::string_view text, const Function& function) {
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::size_t end = text.find('\n');
    const std::string_view line = text.substr(0, end);
    if (!trimmed(line).empty()) function(number, line);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  }
}

/// Before any row is read: other files, and what other programs write, differ here first.
void require_header(const std::string& where, const std::vector<std::string>& header,
                    const std::vector<std::string>& required_columns) {
  const std::string example = fmt::format("{}", fmt::join(required_columns, ","));
  if (header.size() == 1 && header.front().find(';') != std::string::npos)
    throw invalid_input(
        where, fmt::format("semicolons separate its columns: separate them by commas, such as {}", example));
  if (std::ranges::any_of(header, [](const std::string& name) { return parse_double(name).has_value(); }))
    throw invalid_input(
        where,
        fmt::format("the first line is no header, for it has numbers: begin with one such as {}", example));
  for (auto name = header.begin(); name != header.end(); ++name) {
    if (std::find(header.begin(), name, *name) != name)
      throw invalid_input(where, fmt::format("the column '{}' stands twice in the header", *name));
  }
  for (const std::string& name : required_columns) {
    if (std::ranges::find(header, name) == header.end())
      throw invalid_input(
          where, fmt::format("the column '{}' is missing; the header has {}", name, fmt::join(header, ", ")));
  }
}

}  // namespace

CsvTable CsvTable::read_file(const std::filesystem::path& path,
                             const std::vector<std::string>& required_columns) {
  return read_text(apriltrack::read_file(path, kMaxTableBytes), path.string(), required_columns);
}

void CsvTable::add_row(std::size_t line_number, std::string_view line) {
  const std::size_t first = fields_.size();
  for_each_field(line, [&](std::string_view field) {
    const std::ptrdiff_t begin = field.empty() ? 0 : field.data() - text_.data();
    fields_.push_back({static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(field.size())});
  });
  lines_.push_back(line_number);
  const std::size_t count = fields_.size() - first;
  if (count != header_.size())
    throw invalid_input(where(lines_.size() - 1),
                        fmt::format("has {} fields, the header has {}", count, header_.size()));
}

CsvTable CsvTable::read_text(std::string text, const std::string& name,
                             const std::vector<std::string>& required_columns) {
  CsvTable table;
  table.name_ = name;
  APRILTRACK_CHECK(text.size() <= kMaxTableBytes, "places in a table have 32 bits");
  table.text_ = std::move(text);
  std::size_t header_line = 0;
  for_each_line(table.text_, [&](std::size_t number, std::string_view line) {
    if (header_line == 0) {
      header_line = number;
      table.header_ = split_header(line);
      require_header(fmt::format("{}:{}", table.name_, number), table.header_, required_columns);
      return;
    }
    table.add_row(number, line);
  });
  if (header_line == 0) {
    throw invalid_input(table.name_, fmt::format("is empty; it must begin with a header line such as {}",
                                                 fmt::join(required_columns, ",")));
  }
  return table;
}

std::string_view CsvTable::text(std::size_t row, std::string_view column_name) const {
  APRILTRACK_CHECK(row < lines_.size(), "row beyond the end of the table");
  const auto index = column(column_name);
  APRILTRACK_CHECK(index.has_value(), "no such column: " + std::string(column_name));
  const Field& field = fields_[row * header_.size() + *index];
  return std::string_view(text_).substr(field.begin, field.size);
}

double CsvTable::number(std::size_t row, std::string_view column_name) const {
  const std::string_view field = text(row, column_name);
  const auto value = parse_double(field);
  if (!value || !std::isfinite(*value))
    throw invalid_input(where(row), fmt::format("{}: must be a finite number (is '{}')", column_name, field));
  return *value;
}

long long CsvTable::integer(std::size_t row, std::string_view column_name) const {
  const std::string_view field = text(row, column_name);
  const auto value = parse_integer(field);
  if (!value)
    throw invalid_input(where(row), fmt::format("{}: must be a whole number (is '{}')", column_name, field));
  return *value;
}

std::string CsvTable::where(std::size_t row) const {
  APRILTRACK_CHECK(row < lines_.size(), "row beyond the end of the table");
  return fmt::format("{}:{}", name_, lines_[row]);
}

std::optional<std::size_t> CsvTable::column(std::string_view name) const {
  const auto found = std::find(header_.begin(), header_.end(), name);
  if (found == header_.end()) return std::nullopt;
  return static_cast<std::size_t>(found - header_.begin());
}

}  // namespace apriltrack
