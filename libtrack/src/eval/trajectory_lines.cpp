#include "trajectory_lines.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "apriltrack/base/check.h"
#include "apriltrack/base/error.h"
#include "apriltrack/io/numbers.h"
#include "apriltrack/io/trimmed.h"

namespace apriltrack {

std::vector<ContentLine> content_lines(std::string_view contents) {
  std::vector<ContentLine> lines;
  std::size_t number = 0;
  while (!contents.empty()) {
    const std::size_t end = std::min(contents.find('\n'), contents.size());
    std::string_view text = contents.substr(0, end);
    contents.remove_prefix(std::min(end + 1, contents.size()));
    ++number;
    text = text.substr(0, text.find('#'));
    if (text.find_first_not_of(kBlanks) != std::string_view::npos) lines.push_back({text, number});
  }
  return lines;
}

std::vector<std::string_view> split_blanks(std::string_view text) {
  std::vector<std::string_view> fields;
  for (std::size_t begin = text.find_first_not_of(kBlanks); begin != std::string_view::npos;) {
    const std::size_t end = std::min(text.find_first_of(kBlanks, begin), text.size());
    fields.push_back(text.substr(begin, end - begin));
    begin = text.find_first_not_of(kBlanks, end);
  }
  return fields;
}

std::vector<std::string_view> split_commas(std::string_view text) {
  std::vector<std::string_view> fields;
  for (;;) {
    const std::size_t comma = text.find(',');
    fields.push_back(trimmed(text.substr(0, comma)));
    if (comma == std::string_view::npos) return fields;
    text.remove_prefix(comma + 1);
  }
}

std::string without_exponent(std::string_view number) {
  const std::size_t e = number.find_first_of("eE");
  if (e == std::string_view::npos || !parse_double(number)) return std::string(number);
  const auto exponent = parse_integer(number.substr(e + 1));
  if (!exponent || std::abs(*exponent) > 18) return std::string(number);
  std::string mantissa(number.substr(0, e));
  const bool is_negative = mantissa.starts_with('-');
  if (is_negative) mantissa.erase(0, 1);
  std::size_t point = mantissa.find('.');
  if (point == std::string::npos) point = mantissa.size();
  std::string digits = mantissa.substr(0, point) + mantissa.substr(std::min(point + 1, mantissa.size()));
  long long place = static_cast<long long>(point) + *exponent;
  if (place <= 0) {
    digits.insert(0, static_cast<std::size_t>(1 - place), '0');
    place = 1;
  }
  if (digits.size() < static_cast<std::size_t>(place)) digits.resize(static_cast<std::size_t>(place), '0');
  const std::string whole = digits.substr(0, static_cast<std::size_t>(place));
  const std::string decimals = digits.substr(static_cast<std::size_t>(place));
  return (is_negative ? "-" : "") + whole + (decimals.empty() ? "" : "." + decimals);
}

double parse_finite(std::string_view field, std::string_view column, const std::string& where) {
  const auto value = parse_double(field);
  if (!value || !std::isfinite(*value))
    throw invalid_input(where, fmt::format("{}: '{}' is not a finite number", column, field));
  return *value;
}

Trajectory sorted_by_time(std::vector<PoseLine> lines, const std::string& name) {
  std::ranges::stable_sort(lines, {}, [](const PoseLine& line) { return line.pose.timestamp; });
  const auto twin =
      std::ranges::adjacent_find(lines, {}, [](const PoseLine& line) { return line.pose.timestamp; });
  if (twin != lines.end()) {
    throw invalid_input(fmt::format("{}:{}", name, std::next(twin)->number),
                        fmt::format("timestamp {} stands in line {} already; each frame has one pose",
                                    format_seconds(twin->pose.timestamp), twin->number));
  }
  Trajectory trajectory;
  trajectory.reserve(lines.size());
  for (const PoseLine& line : lines) trajectory.push_back(line.pose);
  return trajectory;
}

void check_trajectory(const Trajectory& trajectory) {
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    APRILTRACK_CHECK(i == 0 || trajectory[i - 1].timestamp < trajectory[i].timestamp,
                     "a trajectory is sorted, each time once");
    APRILTRACK_CHECK(trajectory[i].pose.is_finite(), "poses of a trajectory are finite");
  }
}

}  // namespace apriltrack
